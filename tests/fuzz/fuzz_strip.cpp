// Arbitrary bytes as a coded strip, and the same with checksums that fit: refused, or triangles whose corners are
// there.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include <xxhash.h>

#include "talus/failure.hpp"
#include "talus/strip.hpp"

namespace {

using namespace talus;

void require(bool holds) {
  if (!holds) std::abort();
}

void look_at(std::span<const std::byte> bytes) {
  try {
    const Mesh mesh = decode_strip(bytes, 1, 1 << 22);
    require(mesh.points.size() == mesh.heights.size());
    for (const auto& t : mesh.triangles) {
      for (const std::uint32_t v : t) require(v < mesh.points.size());
      const GridPoint a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
      // Counter-clockwise, rows run south.
      require((std::int64_t{b.col} - a.col) * (std::int64_t{c.row} - a.row) <
              (std::int64_t{b.row} - a.row) * (std::int64_t{c.col} - a.col));
    }
    require(strip_sizes(bytes).triangles == mesh.triangles.size());
  } catch (const Failure& failure) {
    require(failure.cause() == Cause::corrupt || failure.cause() == Cause::unsupported);
  }
}

/// Where docs/format/strip.md has the checksums.
void reseal(std::vector<std::byte>& bytes) {
  constexpr std::size_t kHeader = 104;
  if (bytes.size() < kHeader + 8) return;
  const std::uint64_t head = XXH3_64bits(bytes.data(), kHeader - 8);
  std::memcpy(bytes.data() + kHeader - 8, &head, 8);
  const std::uint64_t body = XXH3_64bits_withSeed(bytes.data() + kHeader, bytes.size() - kHeader - 8, head);
  std::memcpy(bytes.data() + bytes.size() - 8, &body, 8);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  look_at(bytes);
  std::vector<std::byte> sealed(bytes.begin(), bytes.end());
  reseal(sealed);
  look_at(sealed);
  return 0;
}
