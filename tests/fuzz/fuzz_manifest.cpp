// Arbitrary bytes as a header: refused, or one that encodes to the same header again.

#include <cstdint>
#include <cstdlib>
#include <span>

#include "engine/page/manifest.hpp"
#include "engine/page/page_layout.hpp"
#include "talus/failure.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace talus;
  Manifest manifest;
  try {
    manifest = decode_manifest(std::as_bytes(std::span(data, size)));
  } catch (const Failure& failure) {
    require(failure.cause() == Cause::corrupt || failure.cause() == Cause::unsupported);
    return 0;
  }
  const Description& d = manifest.description;
  require(d.extent.cols() >= 1 && d.extent.cols() < 2 * std::int64_t{kMaxExtent});
  require(d.extent.rows() >= 1 && d.extent.rows() < 2 * std::int64_t{kMaxExtent});
  require(manifest.bands == band_count(d.extent));
  const auto once = encode(manifest);
  require(encode(decode_manifest(once)) == once);
  return 0;
}
