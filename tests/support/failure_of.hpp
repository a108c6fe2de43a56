#pragma once
// The failure of a piece of work.

#include <functional>
#include <optional>

#include "talus/failure.hpp"

namespace talus::support {

/// Empty: the work did not fail.
inline std::optional<Failure> failure_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Failure& failure) {
    return failure;
  }
  return std::nullopt;
}

}  // namespace talus::support
