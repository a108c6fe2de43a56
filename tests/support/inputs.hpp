#pragma once
// What tests of inputs share.

#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "ingest/mosaic/source.hpp"
#include "talus/failure.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {

inline Source open(const std::filesystem::path& file) { return Source{{file}, {}}; }

/// A window, spelled out.
struct Spelled {
  std::vector<double> codes;
  std::vector<std::uint8_t> valid;
};
inline Spelled spelled(const Window& window) {
  Spelled all{{}, window.valid};
  std::visit([&](const auto& codes) { all.codes.assign(codes.begin(), codes.end()); }, window.codes);
  if (all.valid.empty()) all.valid.assign(all.codes.size(), 1);
  return all;
}
inline Spelled all_codes(const Source& source) { return spelled(source.read(source.description().extent)); }

/// The whole as a terrain of codes, its first sample at (0, 0).
inline Terrain as_terrain(const Source& source) {
  const GridRect extent = source.description().extent;
  Terrain terrain(static_cast<int>(extent.cols()), static_cast<int>(extent.rows()));
  Spelled all = all_codes(source);
  terrain.values = std::move(all.codes);
  terrain.valid = std::move(all.valid);
  return terrain;
}

template <class Action>
Failure failure_of(Action&& action) {
  try {
    action();
  } catch (const Failure& failure) {
    return failure;
  }
  ADD_FAILURE() << "nothing failed";
  return {Cause::io, ""};
}

/// One of the sentences has these words.
inline bool says(const std::vector<std::string>& sentences, const std::string& words) {
  for (const std::string& sentence : sentences) {
    if (sentence.find(words) != std::string::npos) return true;
  }
  return false;
}

}  // namespace talus::support
