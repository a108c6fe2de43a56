// The kernels give the codes of the definition where a hair decides: on the rungs of the ladder and beside them.

#include "engine/error/block_errors.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/error/saturation.hpp"
#include "tests/engine/fields.hpp"

namespace talus::support {
namespace {

/// Vertices of one block of which the kernel, saturated, says something else than the plain loops.
std::size_t different_from_definition(const Field& field) {
  LevelGrid<ErrorCode> plain = reference_errors(field.input, kTileLevels);
  saturate(field.input, plain);
  LevelGrid<ErrorCode> fast(field.extent, kTileLevels, 0);
  detail::block_errors(field.input, {{0, 0}, {0, 0}}, fast);
  saturate(field.input, fast);
  std::size_t different = 0;
  for_each_vertex(plain, [&](GridPoint p) { different += plain[p] != fast[p] ? 1 : 0; });
  return different;
}

TEST(BlockErrors, FloatsOnARungAndBesideItGetTheCodeOfTheDefinition) {
  for (ErrorCode code = 1; code <= kLastFiniteError; code = static_cast<ErrorCode>(code + (code < 400 ? 1 : 7))) {
    const auto rung = static_cast<float>(error_of(code) * (code % 2 == 0 ? 1 : -1));  // all on one side: 24 bits
    Terrain terrain = plane(65, 65, 0, 0, 0);
    terrain.at(7, 20) = static_cast<double>(rung);  // side midpoints of spacing 1 …
    terrain.at(20, 7) = static_cast<double>(std::nextafter(rung, 0.0F));
    terrain.at(33, 34) = static_cast<double>(std::nextafter(rung, 2 * rung));
    terrain.at(40, 52) = static_cast<double>(0.75F * rung);  // … and one of 4, whose planes have slopes
    ASSERT_EQ(different_from_definition(Field(terrain)), 0u) << error_of(code) << " m";
  }
}

TEST(BlockErrors, HeightsTooFarApartForWholeNumbersGetTheCodeOfTheDefinition) {
  for (int exponent = 18; exponent < 32; ++exponent) {  // of the range in units of the finest bit
    Terrain terrain = surface(65, 65, [&](int col, int row) { return (col * 7 + row * 13) % 31 / 32.0; });
    terrain.at(31, 17) = std::ldexp(1.0, exponent - 5) - 1;
    terrain.at(32, 32) = -std::ldexp(1.0, exponent - 5);
    ASSERT_EQ(different_from_definition(Field(terrain)), 0u) << "2^" << exponent;
  }
}

}  // namespace
}  // namespace talus::support
