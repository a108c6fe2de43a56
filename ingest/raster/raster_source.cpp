#include "ingest/raster/raster_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "engine/machine/fail.hpp"
#include "ingest/files/gdal_scope.hpp"

namespace talus {
namespace {

// As wide as T, so that comparisons vectorize.
template <class T>
using Bits =
    std::conditional_t<sizeof(T) == 2, std::int16_t, std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>>;

template <class T>
void turn(const Patch<T>& patch, bool mirrored, bool south_up) {
  for (std::size_t r = 0; mirrored && r < patch.rows; ++r) std::reverse(patch.row(r), patch.row(r) + patch.cols);
  for (std::size_t r = 0; south_up && r < patch.rows / 2; ++r) {
    std::swap_ranges(patch.row(r), patch.row(r) + patch.cols, patch.row(patch.rows - 1 - r));
  }
}

/// The raw samples that mean void. GDAL also accepts floats close to the void value, by a rule that differs between
/// versions. So GDAL is asked about samples from `low` to `high`.
template <class T>
struct VoidValue {
  bool is_stated = false;
  T value = 0, low = 1, high = 0;
};

template <class T>
VoidValue<T> void_value(const RasterFacts& facts) {
  VoidValue<T> rule;
  if (!facts.nodata) return rule;
  rule.is_stated = true;
  rule.value = rule.low = rule.high = static_cast<T>(*facts.nodata);
  if (facts.is_integer()) return rule;
  const double value = *facts.nodata, around = std::abs(value) * 1e-3 + 1e-6;
  constexpr double kHuge = 1e30;  // beyond it, no number is a height
  const double most = std::numeric_limits<T>::max();
  const auto held = [most](double v) { return static_cast<T>(std::clamp(v, -most, most)); };
  rule.low = held(value < -kHuge ? -most : value > kHuge ? kHuge : value - around);
  rule.high = held(value > kHuge ? most : value < -kHuge ? -kHuge : value + around);
  return rule;
}

/// Whether all samples are valid and certainly heights.
template <class T>
bool is_plain(const Patch<T>& patch, const VoidValue<T>& nodata, const SureHeights<T>& sure) {
  const T low = sure.low, high = sure.high, void_low = nodata.low, void_high = nodata.high;
  const auto has_nodata = static_cast<Bits<T>>(nodata.is_stated);
  for (std::size_t r = 0; r < patch.rows; ++r) {
    const T* row = patch.row(r);
    Bits<T> odd = 0;
    for (std::size_t c = 0; c < patch.cols; ++c) {
      const T v = row[c];
      const auto is_void =
          static_cast<Bits<T>>(static_cast<Bits<T>>(v >= void_low) & static_cast<Bits<T>>(v <= void_high) & has_nodata);
      const auto is_height = static_cast<Bits<T>>(static_cast<Bits<T>>(v >= low) & static_cast<Bits<T>>(v <= high));
      odd = static_cast<Bits<T>>(odd | is_void | (is_height ^ 1));
    }
    if (odd != 0) return false;
  }
  return true;
}

/// Marks NaN and exact void values in `valid`.
/// returns  whether some samples are close to the void value
template <class T>
bool mark_voids(const Patch<T>& patch, const VoidValue<T>& nodata, const Patch<std::uint8_t>& valid) {
  const T value = nodata.value, low = nodata.low, high = nodata.high;
  const bool has_nodata = nodata.is_stated;
  bool some_are_close = false;
  for (std::size_t r = 0; r < patch.rows; ++r) {
    const T* row = patch.row(r);
    std::uint8_t* ok = valid.row(r);
    bool close = false;
    for (std::size_t c = 0; c < patch.cols; ++c) {
      const T v = row[c];
      const bool is_data = !((v == value) & has_nodata) & (v == v) & (ok[c] != 0);
      close |= is_data & (v >= low) & (v <= high);
      ok[c] = static_cast<std::uint8_t>(is_data);
    }
    some_are_close |= close;
  }
  return some_are_close && has_nodata;
}

template <class T>
void mark_value(const Patch<T>& patch, T value, const Patch<std::uint8_t>& valid) {
  for (std::size_t r = 0; r < patch.rows; ++r) {
    const T* row = patch.row(r);
    std::uint8_t* ok = valid.row(r);
    for (std::size_t c = 0; c < patch.cols; ++c) ok[c] = static_cast<std::uint8_t>((ok[c] != 0) & (row[c] != value));
  }
}

/// Marks samples as void where `other` is 0.
template <class T>
void mark_where_0(const Patch<T>& other, const Patch<std::uint8_t>& valid) {
  for (std::size_t r = 0; r < valid.rows; ++r) {
    const T* row = other.row(r);
    std::uint8_t* ok = valid.row(r);
    for (std::size_t c = 0; c < valid.cols; ++c) ok[c] = static_cast<std::uint8_t>((ok[c] != 0) & (row[c] != 0));
  }
}

template <class T>
void clear_voids(const Patch<T>& patch, const Patch<std::uint8_t>& valid) {
  for (std::size_t r = 0; r < patch.rows; ++r) {
    T* row = patch.row(r);
    const std::uint8_t* ok = valid.row(r);
    for (std::size_t c = 0; c < patch.cols; ++c) row[c] = ok[c] != 0 ? row[c] : T{0};
  }
}

/// Memory for another band of the same rectangle.
template <class T>
struct Beside {
  explicit Beside(std::size_t cols, std::size_t rows) : memory(cols * rows), patch{memory.data(), cols, rows, cols} {}
  std::vector<T> memory;
  Patch<T> patch;
};

}  // namespace

GDALRasterBandH RasterSource::band(int number) const {
  GDALDatasetH dataset = dataset_.get();
  return number > GDALGetRasterCount(dataset) ? nullptr : GDALGetRasterBand(dataset, number);
}

RasterSource::RasterSource(const RasterFacts& facts)
    : facts_(facts), dataset_(open_dataset(facts)), band_(band(facts.band)) {
  GDALDatasetH dataset = dataset_.get();
  const GDALDataType type = facts.decode == ColourCode::none ? facts.type : GDT_Byte;
  for (const int number : facts.alphas) alphas_.push_back(band(number));
  if (band_ == nullptr || std::count(alphas_.begin(), alphas_.end(), nullptr) > 0 ||
      GDALGetRasterXSize(dataset) != facts.cols || GDALGetRasterYSize(dataset) != facts.rows ||
      GDALGetRasterDataType(band_) != type) {
    fail_in(facts.name, Cause::io, "{} changed while it was read", facts.name);
  }
  if (facts.masked) mask_ = GDALGetMaskBand(band_);
  if (facts.nodata && GDALGetMaskFlags(band_) == GMF_NODATA) nodata_mask_ = GDALGetMaskBand(band_);
}

template <class T>
void RasterSource::read_band(GDALRasterBandH band, GridRect part, const Patch<T>& samples) const {
  GdalScope gdal;
  const GridRect& place = facts_.place;
  const int cols = static_cast<int>(part.cols()), rows = static_cast<int>(part.rows());
  const int x = facts_.is_mirrored ? place.last.col - part.last.col : part.first.col - place.first.col;
  const int y = facts_.is_south_up ? place.last.row - part.last.row : part.first.row - place.first.row;
  const CPLErr outcome = GDALRasterIOEx(band, GF_Read, x, y, cols, rows, samples.samples, cols, rows, kGdalType<T>, 0,
                                        static_cast<GSpacing>(samples.stride * sizeof(T)), nullptr);
  if (outcome != CE_None || !gdal.reason().empty()) {
    fail_in(facts_.name, Cause::io, "cannot read columns {} to {}, rows {} to {} of {}{}", x, x + cols - 1, y,
            y + rows - 1, facts_.name, gdal.reason());
  }
  turn(samples, facts_.is_mirrored, facts_.is_south_up);
}

template <class T>
void RasterSource::read_samples(GridRect part, const Patch<T>& samples) const {
  if (facts_.decode == ColourCode::none) return read_band(band_, part, samples);
  const Beside<std::uint8_t> red(samples.cols, samples.rows), green(samples.cols, samples.rows),
      blue(samples.cols, samples.rows);
  read_band(band_, part, red.patch);
  read_band(band(facts_.band + 1), part, green.patch);
  read_band(band(facts_.band + 2), part, blue.patch);
  for (std::size_t r = 0; r < samples.rows; ++r) {
    for (std::size_t c = 0; c < samples.cols; ++c) {
      samples.row(r)[c] = static_cast<T>(65536 * int{red.patch.row(r)[c]} + 256 * int{green.patch.row(r)[c]} +
                                         int{blue.patch.row(r)[c]});
    }
  }
}

template <class T>
bool RasterSource::read(GridRect part, const RasterCoding& coding, T* codes, std::size_t stride,
                        const std::function<std::uint8_t*()>& valid_at) const {
  const Patch<T> patch{codes, static_cast<std::size_t>(part.cols()), static_cast<std::size_t>(part.rows()), stride};
  read_samples(part, patch);

  const VoidValue<T> nodata = void_value<T>(facts_);
  const bool says_only_nodata = mask_ == nullptr && alphas_.empty() && facts_.assumed_voids.empty();
  if (says_only_nodata && coding.rule == RasterCoding::Rule::raw &&
      is_plain(patch, nodata, sure_heights<T>(facts_, coding)))
    return false;
  const Patch<std::uint8_t> valid{valid_at(), patch.cols, patch.rows, stride};
  if (mask_ != nullptr) {
    read_band(mask_, part, valid);
  } else {
    for (std::size_t r = 0; r < valid.rows; ++r) std::fill_n(valid.row(r), valid.cols, std::uint8_t{1});
  }
  if (mark_voids(patch, nodata, valid) && nodata_mask_ != nullptr) {
    const Beside<std::uint8_t> mask(patch.cols, patch.rows);
    read_band(nodata_mask_, part, mask.patch);
    mark_where_0(mask.patch, valid);
  }
  for (const double value : facts_.assumed_voids) mark_value(patch, static_cast<T>(value), valid);
  for (GDALRasterBandH alpha : alphas_) {
    const Beside<float> transparency(patch.cols, patch.rows);
    read_band(alpha, part, transparency.patch);
    mark_where_0(transparency.patch, valid);
  }
  clear_voids(patch, valid);
  code_heights(patch, valid, facts_, coding,
               {part.first.col - facts_.place.first.col, part.first.row - facts_.place.first.row});
  return true;
}

using ValidAt = std::function<std::uint8_t*()>;
template bool RasterSource::read(GridRect, const RasterCoding&, std::int16_t*, std::size_t, const ValidAt&) const;
template bool RasterSource::read(GridRect, const RasterCoding&, float*, std::size_t, const ValidAt&) const;
template bool RasterSource::read(GridRect, const RasterCoding&, double*, std::size_t, const ValidAt&) const;

}  // namespace talus
