#pragma once
// Encodes a picture as a .png file.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace talus {

/// rgb    three bytes a pixel, row by row from the top
/// fails  unsupported: this GDAL writes no PNG; io
[[nodiscard]] std::vector<std::byte> png_bytes(std::span<const std::uint8_t> rgb, int width, int height);

}  // namespace talus
