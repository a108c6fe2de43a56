#include "query/rasters/png_bytes.hpp"

#include <atomic>
#include <cassert>
#include <memory>
#include <string>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal.h>

#include "engine/machine/fail.hpp"

namespace talus {
namespace {

struct Quiet {
  Quiet() { CPLPushErrorHandler(CPLQuietErrorHandler); }
  ~Quiet() { CPLPopErrorHandler(); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
};

struct Close {
  void operator()(void* dataset) const { GDALClose(dataset); }
};

}  // namespace

// Encodes by GDAL in memory, without side files.
std::vector<std::byte> png_bytes(std::span<const std::uint8_t> rgb, int width, int height) {
  assert(rgb.size() == 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  static std::atomic<unsigned> pictures = 0;
  GDALAllRegister();
  const Quiet quiet;
  const std::string name = fmt::format("/vsimem/talus-{}.png", pictures++);
  const auto require = [&](bool done) {
    if (!done) fail(Cause::io, "cannot make a PNG picture: {}", CPLGetLastErrorMsg());
  };
  GDALDriverH memory = GDALGetDriverByName("MEM"), png = GDALGetDriverByName("PNG");
  if (memory == nullptr || png == nullptr) throw Failure(Cause::unsupported, "this GDAL writes no PNG pictures");
  const std::unique_ptr<void, Close> picture{GDALCreate(memory, "", width, height, 3, GDT_Byte, nullptr)};
  require(picture != nullptr);
  // GDAL wants a mutable pointer, but only reads.
  auto* const pixels = const_cast<std::uint8_t*>(rgb.data());
  require(GDALDatasetRasterIO(picture.get(), GF_Write, 0, 0, width, height, pixels, width, height, GDT_Byte, 3, nullptr,
                              3, 3 * width, 1) == CE_None);
  std::unique_ptr<void, Close> copy{GDALCreateCopy(png, name.c_str(), picture.get(), FALSE, nullptr, nullptr, nullptr)};
  require(copy != nullptr);
  copy.reset();
  vsi_l_offset size = 0;
  const std::unique_ptr<GByte, decltype(&VSIFree)> bytes{VSIGetMemFileBuffer(name.c_str(), &size, TRUE), &VSIFree};
  require(bytes != nullptr);
  const auto* const first = reinterpret_cast<const std::byte*>(bytes.get());
  return {first, first + size};
}

}  // namespace talus
