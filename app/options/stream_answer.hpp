#pragma once
// Answers out of .rqt files.

#include <string>

#include "talus/stream.hpp"

namespace talus::app {

/// Takes a stream's answer out of it.
/// fails  invalid_argument: it is an increment
[[nodiscard]] RestrictedQuadtree answer_of(Stream& stream, const std::string& file);

}  // namespace talus::app
