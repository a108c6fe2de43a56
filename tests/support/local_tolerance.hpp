#pragma once
// A tolerance that varies, held against every sample.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "talus/quadtree.hpp"
#include "talus/question.hpp"
#include "tests/support/surfaces.hpp"

namespace talus::support {

/// Every sample under a triangle against the tolerance at that sample.
inline void expect_local_tolerance(const Mesh& mesh, const Terrain& terrain, double metres_per_unit,
                                   const ToleranceField& field, const std::string& name) {
  for (const auto& t : mesh.triangles) {
    const GridPoint a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const double area = double(b.col - a.col) * (c.row - a.row) - double(b.row - a.row) * (c.col - a.col);
    for (int row = std::min({a.row, b.row, c.row}); row <= std::max({a.row, b.row, c.row}); ++row) {
      for (int col = std::min({a.col, b.col, c.col}); col <= std::max({a.col, b.col, c.col}); ++col) {
        const double u = (double(b.col - col) * (c.row - row) - double(b.row - row) * (c.col - col)) / area;
        const double v = (double(c.col - col) * (a.row - row) - double(c.row - row) * (a.col - col)) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const auto at =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(terrain.cols) + static_cast<std::size_t>(col);
        if (terrain.valid[at] == 0) continue;
        const double surface = u * mesh.heights[t[0]] + v * mesh.heights[t[1]] + (1 - u - v) * mesh.heights[t[2]];
        const double error = std::abs(terrain.values[at] - surface) * metres_per_unit;
        const double tolerance = field.at({col, row}).value;
        ASSERT_LE(error, tolerance + 1e-6 + 1e-9 * std::abs(terrain.values[at]))
            << name << ": sample " << col << ',' << row;
      }
    }
  }
}

}  // namespace talus::support
