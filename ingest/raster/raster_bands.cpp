#include "ingest/raster/raster_bands.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"

namespace talus {
namespace {

/// The kind of colour in a band, in words; null if it may hold heights.
const char* colour_of(GDALRasterBandH band) {
  const GDALColorInterp meaning = GDALGetRasterColorInterpretation(band);
  if (meaning == GCI_PaletteIndex ||
      (GDALGetRasterDataType(band) == GDT_Byte && GDALGetRasterColorTable(band) != nullptr))
    return "a palette";
  if (meaning == GCI_Undefined || meaning == GCI_GrayIndex || meaning == GCI_AlphaBand) return nullptr;
  return GDALGetColorInterpretationName(meaning);
}

[[noreturn]] void refuse_colours(const RasterFacts& facts, int band, const char* colour) {
  fail_in(facts.name, Cause::unsupported,
          "{} holds colours, not heights: band {} is {}. If the colours encode heights, name the code with "
          "InputOptions::decode: terrain-rgb or terrarium. If the band holds heights, mark it with gdal_translate "
          "-colorinterp gray",
          facts.name, band, colour);
}

/// Requires red, green and blue, and perhaps alpha.
void require_colours(GDALDatasetH dataset, const InputOptions& options, const RasterFacts& facts) {
  const int bands = GDALGetRasterCount(dataset) - static_cast<int>(facts.alphas.size());
  bool are_bytes = bands == 3 && (facts.alphas.empty() || facts.alphas.front() == 4);
  for (int i = 1; are_bytes && i <= bands; ++i)
    are_bytes = GDALGetRasterDataType(GDALGetRasterBand(dataset, i)) == GDT_Byte;
  if (!are_bytes || options.band != 0) {
    fail_in(facts.name, Cause::invalid_argument,
            "{}: InputOptions::decode needs three bands of bytes, red, green and blue, and perhaps alpha{}", facts.name,
            are_bytes ? ". Remove InputOptions::band" : "");
  }
  constexpr std::array kOrder{GCI_RedBand, GCI_GreenBand, GCI_BlueBand};
  for (int i = 1; i <= bands; ++i) {
    GDALRasterBandH band = GDALGetRasterBand(dataset, i);
    const GDALColorInterp meaning = GDALGetRasterColorInterpretation(band);
    if (meaning != kOrder[static_cast<std::size_t>(i - 1)] && meaning != GCI_Undefined && meaning != GCI_GrayIndex) {
      fail_in(facts.name, Cause::invalid_argument,
              "{}: band {} is {}, but InputOptions::decode needs red, green and blue in this order. Reorder the bands "
              "with gdal_translate -b",
              facts.name, i, GDALGetColorInterpretationName(meaning));
    }
    if (GDALGetRasterScale(band, nullptr) != 1 || GDALGetRasterOffset(band, nullptr) != 0) {
      fail_in(facts.name, Cause::invalid_argument,
              "{}: band {} has a scale or an offset, but colours that encode heights have none", facts.name, i);
    }
  }
  const char* compression = GDALGetMetadataItem(dataset, "COMPRESSION", "IMAGE_STRUCTURE");
  const std::string_view kind = compression == nullptr ? "" : compression;
  if (kind.find("JPEG") != std::string_view::npos || kind == "WEBP" || kind == "JXL" ||
      kind.find("LERC") != std::string_view::npos) {
    const char* reversible = GDALGetMetadataItem(dataset, "COMPRESSION_REVERSIBILITY", "IMAGE_STRUCTURE");
    if (reversible == nullptr || !std::string_view(reversible).starts_with("LOSSLESS")) {
      fail_in(facts.name, Cause::unsupported,
              "{} is compressed by {}, which changes colours a little and so the encoded heights by thousands of "
              "metres. Use a copy without lossy compression",
              facts.name, kind);
    }
  }
}

}  // namespace

void take_band(GDALDatasetH dataset, const InputOptions& options, RasterFacts& facts) {
  const int bands = GDALGetRasterCount(dataset);
  std::vector<int> others;
  for (int i = 1; i <= bands; ++i) {
    const bool is_alpha = GDALGetRasterColorInterpretation(GDALGetRasterBand(dataset, i)) == GCI_AlphaBand;
    (is_alpha ? facts.alphas : others).push_back(i);
  }
  if (others.empty()) {
    fail_in(facts.name, Cause::invalid_argument, "{} has no band of heights{}", facts.name,
            bands > 0 ? ": it has alpha only" : "");
  }
  facts.decode = options.decode;
  if (facts.decode != ColourCode::none) return require_colours(dataset, options, facts);
  for (const int i : others) {
    if (const char* colour = colour_of(GDALGetRasterBand(dataset, i))) refuse_colours(facts, i, colour);
  }
  facts.band = options.band == 0 ? others.front() : options.band;
  if (std::find(others.begin(), others.end(), facts.band) == others.end()) {
    fail_in(facts.name, Cause::invalid_argument,
            "{} has {} band{}{}, so InputOptions::band {} is not a band of heights", facts.name, bands,
            bands == 1 ? "" : "s", facts.alphas.empty() ? "" : ", alpha among them", facts.band);
  }
  if (others.size() > 1 && options.band == 0) {
    facts.notes.push_back(fmt::format(
        "has {} bands of heights; Talus read the first (InputOptions::band chooses another)", others.size()));
  }
}

void take_colour_code(RasterFacts& facts) {
  if (facts.decode == ColourCode::none) return;
  facts.type = GDT_UInt32;
  facts.scale = facts.decode == ColourCode::terrarium ? 1.0 / 256 : 0.1;
  facts.offset = facts.decode == ColourCode::terrarium ? -32768 : -10000;
}

}  // namespace talus
