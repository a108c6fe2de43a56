#include "ingest/raster_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include <fmt/format.h>

#include "ingest/gdal_scope.hpp"
#include "ingest/warp.hpp"
#include "talus/failure.hpp"

namespace talus {
namespace {

template <class T>
constexpr GDALDataType kGdalType = std::is_same_v<T, std::int16_t> ? GDT_Int16
                                   : std::is_same_v<T, float>      ? GDT_Float32
                                                                   : GDT_Float64;
// As wide as T, so that comparisons stay in their lanes.
template <class T>
using Bits =
    std::conditional_t<sizeof(T) == 2, std::int16_t, std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>>;

/// A rectangle of samples somewhere in a larger one.
template <class T>
struct Patch {
  T* samples;
  std::size_t cols, rows, stride;
  [[nodiscard]] T* row(std::size_t r) const { return samples + r * stride; }
};

template <class T>
void turn(const Patch<T>& patch, bool mirrored, bool south_up) {
  for (std::size_t r = 0; mirrored && r < patch.rows; ++r) std::reverse(patch.row(r), patch.row(r) + patch.cols);
  for (std::size_t r = 0; south_up && r < patch.rows / 2; ++r) {
    std::swap_ranges(patch.row(r), patch.row(r) + patch.cols, patch.row(patch.rows - 1 - r));
  }
}

/// What raw samples say by themselves. Limits lie a little inside the largest heights: beyond them, look closely.
template <class T>
struct RawRule {
  bool has_nodata = false;
  T nodata = 0, low = std::numeric_limits<T>::lowest(), high = std::numeric_limits<T>::max();
};

template <class T>
RawRule<T> raw_rule(const RasterFacts& facts, const Coding& coding) {
  RawRule<T> rule;
  if (facts.nodata && !facts.warp) rule.has_nodata = true, rule.nodata = static_cast<T>(*facts.nodata);
  if (coding.rule != Coding::Rule::raw) return rule;
  const HeightStep& step = coding.step;
  const double scale = step.integer ? step.scale / step.divisor : 1, offset = step.integer ? step.offset : 0;
  const double largest = kLargestHeight / facts.metres_per_unit * (1 - 1e-9);
  const double a = (-largest - offset) / scale, b = (largest - offset) / scale;
  const auto held = [](double v) {
    return static_cast<T>(
        std::clamp(std::trunc(v), double{std::numeric_limits<T>::lowest()}, double{std::numeric_limits<T>::max()}));
  };
  rule.low = held(std::min(a, b));
  rule.high = held(std::max(a, b));
  return rule;
}

/// All data, all heights.
template <class T>
bool is_plain(const Patch<T>& patch, const RawRule<T>& rule) {
  const T nodata = rule.nodata, low = rule.low, high = rule.high;
  const auto has_nodata = static_cast<Bits<T>>(rule.has_nodata);
  for (std::size_t r = 0; r < patch.rows; ++r) {
    const T* row = patch.row(r);
    Bits<T> odd = 0;
    for (std::size_t c = 0; c < patch.cols; ++c) {
      const T v = row[c];
      const auto is_void = static_cast<Bits<T>>(static_cast<Bits<T>>(v == nodata) & has_nodata);
      const auto is_height = static_cast<Bits<T>>(static_cast<Bits<T>>(v >= low) & static_cast<Bits<T>>(v <= high));
      odd = static_cast<Bits<T>>(odd | is_void | (is_height ^ 1));
    }
    if (odd != 0) return false;
  }
  return true;
}

/// Marks voids in `valid`, which holds the mask, and makes their samples 0.
template <class T>
void mark_voids(const Patch<T>& patch, const RawRule<T>& rule, const Patch<std::uint8_t>& valid) {
  const T nodata = rule.nodata;
  const bool has_nodata = rule.has_nodata;
  for (std::size_t r = 0; r < patch.rows; ++r) {
    T* row = patch.row(r);
    std::uint8_t* ok = valid.row(r);
    for (std::size_t c = 0; c < patch.cols; ++c) {
      const T v = row[c];
      const bool is_data = !((v == nodata) & has_nodata) & (v == v) & (ok[c] != 0);
      ok[c] = static_cast<std::uint8_t>(is_data);
      row[c] = is_data ? v : T{0};
    }
  }
}

}  // namespace

RasterSource::RasterSource(const RasterFacts& facts) : facts_(facts), dataset_(open_dataset(facts)) {
  GDALDatasetH dataset = dataset_.get();
  GDALRasterBandH first = GDALGetRasterCount(dataset) < 1 ? nullptr : GDALGetRasterBand(dataset, 1);
  if (first == nullptr || GDALGetRasterXSize(dataset) != facts.cols || GDALGetRasterYSize(dataset) != facts.rows ||
      GDALGetRasterDataType(first) != facts.type) {
    throw Failure(Cause::io, fmt::format("{} changed while it was being read", facts.name));
  }
  band_ = first;
  if (facts.warp) {
    warped_ = warp_dataset(dataset, facts);
    band_ = GDALGetRasterBand(warped_.get(), 1);
    mask_ = GDALGetRasterBand(warped_.get(), 2);
  } else if (facts.masked) {
    mask_ = GDALGetMaskBand(band_);
  }
}

void RasterSource::read_raw(GDALRasterBandH band, GDALDataType as, GridRect part, void* samples,
                            std::size_t row_bytes) const {
  GdalScope gdal;
  const GridRect& place = facts_.place;
  const int cols = static_cast<int>(part.cols()), rows = static_cast<int>(part.rows());
  const int x = facts_.is_mirrored && !facts_.warp ? place.last.col - part.last.col : part.first.col - place.first.col;
  const int y = facts_.is_south_up && !facts_.warp ? place.last.row - part.last.row : part.first.row - place.first.row;
  const CPLErr outcome = GDALRasterIOEx(band, GF_Read, x, y, cols, rows, samples, cols, rows, as, 0,
                                        static_cast<GSpacing>(row_bytes), nullptr);
  // Resampling complains of points that have no place in the other CRS, and goes on rightly.
  if (outcome == CE_None && (facts_.warp || gdal.reason().empty())) return;
  throw Failure(Cause::io, fmt::format("cannot read columns {} to {}, rows {} to {} of {}{}", x, x + cols - 1, y,
                                       y + rows - 1, facts_.name, gdal.reason()));
}

template <class T>
bool RasterSource::read(GridRect part, const Coding& coding, T* codes, std::size_t stride,
                        const std::function<std::uint8_t*()>& valid_at) const {
  const Patch<T> patch{codes, static_cast<std::size_t>(part.cols()), static_cast<std::size_t>(part.rows()), stride};
  const bool mirrored = facts_.is_mirrored && !facts_.warp, south_up = facts_.is_south_up && !facts_.warp;
  read_raw(band_, kGdalType<T>, part, codes, stride * sizeof(T));
  turn(patch, mirrored, south_up);

  const RawRule<T> rule = raw_rule<T>(facts_, coding);
  if (mask_ == nullptr && coding.rule == Coding::Rule::raw && is_plain(patch, rule)) return false;
  const Patch<std::uint8_t> valid{valid_at(), patch.cols, patch.rows, stride};
  if (mask_ != nullptr) {
    read_raw(mask_, GDT_Byte, part, valid.samples, stride);
    turn(valid, mirrored, south_up);
  } else {
    for (std::size_t r = 0; r < valid.rows; ++r) std::fill_n(valid.row(r), valid.cols, std::uint8_t{1});
  }
  mark_voids(patch, rule, valid);

  const double largest = kLargestHeight / facts_.metres_per_unit;
  const bool is_integer = facts_.is_integer();
  const HeightStep own{facts_.scale, 1, facts_.offset, true}, step = coding.step;
  const auto value_of = [&](double raw) {
    if (is_integer) return own.value(raw);
    const double scaled = raw * facts_.scale;
    return facts_.offset != 0 ? scaled + facts_.offset : scaled;  // -0.0 + 0 is 0
  };
  for (std::size_t r = 0; r < patch.rows; ++r) {
    T* row = patch.row(r);
    const std::uint8_t* ok = valid.row(r);
    for (std::size_t c = 0; c < patch.cols; ++c) {
      if (ok[c] == 0 || (coding.rule == Coding::Rule::raw && row[c] >= rule.low && row[c] <= rule.high)) continue;
      const double value = value_of(static_cast<double>(row[c]));
      if (!(std::abs(value) <= largest)) {
        throw Failure(
            Cause::invalid_argument,
            fmt::format("{} holds {} {} at column {}, row {}, which is no height (at most {} m up or down); "
                        "if it means no data, declare it: gdal_translate -a_nodata",
                        facts_.name, value, facts_.vertical_unit,
                        part.first.col - facts_.place.first.col + static_cast<std::int64_t>(c),
                        part.first.row - facts_.place.first.row + static_cast<std::int64_t>(r), kLargestHeight));
      }
      if (coding.rule == Coding::Rule::value) row[c] = static_cast<T>(value);
      if (coding.rule == Coding::Rule::rounded) {
        row[c] = static_cast<T>(std::nearbyint((value - step.offset) * step.divisor / step.scale) + 0.0);
      }
    }
  }
  return true;
}

using ValidAt = std::function<std::uint8_t*()>;
template bool RasterSource::read(GridRect, const Coding&, std::int16_t*, std::size_t, const ValidAt&) const;
template bool RasterSource::read(GridRect, const Coding&, float*, std::size_t, const ValidAt&) const;
template bool RasterSource::read(GridRect, const Coding&, double*, std::size_t, const ValidAt&) const;

}  // namespace talus
