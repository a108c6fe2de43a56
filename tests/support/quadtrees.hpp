#pragma once
// Quadtrees held against each other, and what a border forces held apart.

#include <bit>
#include <string>

#include <gtest/gtest.h>

#include "talus/quadtree.hpp"

namespace talus::support {

/// What differs, bit for bit; empty if nothing does.
inline std::string difference(const RestrictedQuadtree& a, const RestrictedQuadtree& b) {
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v); };
  if (!(a.region == b.region)) return "region";
  if (!(a.vertices.region() == b.vertices.region())) return "window";
  if (a.vertices.size() != b.vertices.size())
    return "vertices: " + std::to_string(a.vertices.size()) + " and " + std::to_string(b.vertices.size());
  std::string found;
  a.vertices.for_each([&](GridPoint p) {
    if (!b.vertices.contains(p)) found = "vertex " + std::to_string(p.col) + "/" + std::to_string(p.row);
  });
  if (!found.empty()) return found;
  if (a.heights.size() != b.heights.size()) return "number of heights";
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    if (bits(a.heights[i]) != bits(b.heights[i])) return "height " + std::to_string(i);
  }
  if (a.covers != b.covers) return "covers";
  if (bits(a.tolerance.value) != bits(b.tolerance.value)) return "tolerance";
  if (bits(a.bound.value) != bits(b.bound.value))
    return "bound: " + std::to_string(a.bound.value) + " and " + std::to_string(b.bound.value);
  if (a.origin != b.origin) return "origin";
  if (a.level_errors.size() != b.level_errors.size()) return "levels";
  for (std::size_t i = 0; i < a.level_errors.size(); ++i) {
    if (bits(a.level_errors[i]) != bits(b.level_errors[i])) return "error of level " + std::to_string(i);
  }
  return "";
}

}  // namespace talus::support
