#include "ingest/mosaic/laid_rasters.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <utility>

#include <gdal_priv.h>

#include "engine/quadtree/rect.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/mosaic/common_grid.hpp"
#include "ingest/raster/open_rasters.hpp"

namespace talus {
namespace {

constexpr int kBlockSide = 256;

class LaidDataset;

/// A band of the dataset, or the mask of its first band.
class LaidBand : public GDALRasterBand {
 public:
  enum class Kind { samples, mask, owner };
  LaidBand(LaidDataset& dataset, int number, Kind kind, GDALDataType type);

  GDALRasterBand* GetMaskBand() override { return mask_ == nullptr ? GDALRasterBand::GetMaskBand() : mask_; }
  int GetMaskFlags() override { return mask_ == nullptr ? GDALRasterBand::GetMaskFlags() : GMF_PER_DATASET; }
  void set_mask(GDALRasterBand& mask) { mask_ = &mask; }

 protected:
  CPLErr IReadBlock(int x, int y, void* to) override;

 private:
  LaidDataset& laid_;
  Kind kind_;
  GDALRasterBand* mask_ = nullptr;
};

class LaidDataset : public GDALDataset {
 public:
  LaidDataset(const LaidRasters& laid, GridRect part)
      : laid_(laid), part_(part), open_(laid.members, kMostOpen), geotransform_(laid.geotransform) {
    nRasterXSize = static_cast<int>(part.cols());
    nRasterYSize = static_cast<int>(part.rows());
    const double east = part.first.col - laid.extent.first.col, south = part.first.row - laid.extent.first.row;
    geotransform_[0] += east * geotransform_[1] + south * geotransform_[2];
    geotransform_[3] += east * geotransform_[4] + south * geotransform_[5];
    const bool is_raw = laid.type == laid.members.front().type && laid.scale == laid.members.front().scale &&
                        laid.offset == laid.members.front().offset;
    coding_.rule = is_raw ? RasterCoding::Rule::raw : RasterCoding::Rule::value;
    coding_.step = {laid.scale, 1, laid.offset, laid.members.front().is_integer()};
    mask_ = std::make_unique<LaidBand>(*this, 0, LaidBand::Kind::mask, GDT_Byte);
    auto* samples = new LaidBand(*this, 1, LaidBand::Kind::samples, laid.type);
    samples->set_mask(*mask_);
    SetBand(1, samples);
    SetBand(2, new LaidBand(*this, 2, LaidBand::Kind::owner, GDT_Int32));
  }
  ~LaidDataset() override {
    FlushCache(true);
    mask_.reset();
  }

  CPLErr GetGeoTransform(double* to) override {
    std::copy(geotransform_.begin(), geotransform_.end(), to);
    return CE_None;
  }

  struct Block {
    int x = -1, y = -1;
    std::vector<double> samples;
    std::vector<std::uint8_t> valid;
    std::vector<std::int32_t> owner;
  };
  /// Lays a block, unless it is the last one: GDAL asks for its samples, mask and owners in turn. Null if that fails.
  const Block* block(int x, int y) noexcept {
    if (block_.x == x && block_.y == y) return &block_;
    try {
      block_.x = -1;
      lay(x, y);
      block_.x = x, block_.y = y;
      return &block_;
    } catch (...) {
      failure_ = std::current_exception();
      return nullptr;
    }
  }
  void rethrow() {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  static constexpr std::size_t kMostOpen = 16;

  void lay(int x, int y) {
    constexpr std::size_t kSamples = std::size_t{kBlockSide} * kBlockSide;
    block_.samples.assign(kSamples, 0);
    block_.valid.assign(kSamples, 0);
    block_.owner.assign(kSamples, 0);
    const GridPoint first{part_.first.col + x * kBlockSide, part_.first.row + y * kBlockSide};
    const GridRect square{
        first,
        {std::min(first.col + kBlockSide - 1, part_.last.col), std::min(first.row + kBlockSide - 1, part_.last.row)}};
    for (std::size_t i = 0; i < laid_.members.size(); ++i) {
      const GridRect rect = common(laid_.members[i].place, square);
      if (is_empty(rect)) continue;
      const auto samples = static_cast<std::size_t>(rect.samples());
      read_.resize(samples);
      read_valid_.assign(samples, 1);
      open_.get(i).read(rect, coding_, read_.data(), static_cast<std::size_t>(rect.cols()),
                        [&] { return read_valid_.data(); });
      lay_member(static_cast<std::int32_t>(i) + 1, rect, first);
    }
  }

  /// Copies a member's valid samples. It owns its void samples only where no other member is valid.
  void lay_member(std::int32_t number, GridRect rect, GridPoint first) {
    std::size_t from = 0;
    for (std::int32_t row = rect.first.row; row <= rect.last.row; ++row) {
      auto to =
          static_cast<std::size_t>(row - first.row) * kBlockSide + static_cast<std::size_t>(rect.first.col - first.col);
      for (std::int32_t col = rect.first.col; col <= rect.last.col; ++col, ++from, ++to) {
        if (read_valid_[from] != 0) {
          block_.samples[to] = read_[from];
          block_.valid[to] = 255;
          block_.owner[to] = number;
        } else if (block_.valid[to] == 0) {
          block_.owner[to] = number;
        }
      }
    }
  }

  const LaidRasters& laid_;
  GridRect part_;
  OpenRasters open_;
  RasterCoding coding_;
  std::array<double, 6> geotransform_;
  std::unique_ptr<LaidBand> mask_;
  Block block_;
  std::vector<double> read_;
  std::vector<std::uint8_t> read_valid_;
  std::exception_ptr failure_;
};

LaidBand::LaidBand(LaidDataset& dataset, int number, Kind kind, GDALDataType type) : laid_(dataset), kind_(kind) {
  poDS = &dataset;
  nBand = number;
  eDataType = type;
  nRasterXSize = dataset.GetRasterXSize();
  nRasterYSize = dataset.GetRasterYSize();
  nBlockXSize = nBlockYSize = kBlockSide;
}

CPLErr LaidBand::IReadBlock(int x, int y, void* to) {
  const LaidDataset::Block* block = laid_.block(x, y);
  if (block == nullptr) {
    CPLError(CE_Failure, CPLE_FileIO, "a raster under this dataset cannot be read");
    return CE_Failure;
  }
  constexpr int kSamples = kBlockSide * kBlockSide;
  if (kind_ == Kind::samples) {
    GDALCopyWords(block->samples.data(), GDT_Float64, sizeof(double), to, eDataType,
                  GDALGetDataTypeSizeBytes(eDataType), kSamples);
  } else if (kind_ == Kind::mask) {
    std::copy(block->valid.begin(), block->valid.end(), static_cast<std::uint8_t*>(to));
  } else {
    std::copy(block->owner.begin(), block->owner.end(), static_cast<std::int32_t*>(to));
  }
  return CE_None;
}

/// A single raster on its own grid.
LaidRasters alone(const RasterFacts& raster) {
  LaidRasters laid;
  laid.members.push_back(raster);
  RasterFacts& only = laid.members.front();
  only.place = {{0, 0}, {raster.cols - 1, raster.rows - 1}};
  laid.mapping = raster.mapping;
  laid.extent = only.place;
  const GridMapping& m = raster.mapping;
  const bool is_turned = raster.is_mirrored || raster.is_south_up;
  laid.geotransform = raster.geotransform;
  if (is_turned) laid.geotransform = {m.x0 - 0.5 * m.dx, m.dx, 0, m.y0 - 0.5 * m.dy, 0, m.dy};
  laid.crs_wkt = raster.crs_wkt;
  laid.type = raster.type;
  laid.scale = raster.scale;
  laid.offset = raster.offset;
  return laid;
}

void measure_extent(LaidRasters& laid) {
  GridRect all = laid.members.front().place;
  for (const RasterFacts& member : laid.members) {
    all = around(all, member.place);
    if (member.type == laid.type && member.scale == laid.scale && member.offset == laid.offset) continue;
    laid.type = GDT_Float64;  // heights: the members' numbers have different scales
    laid.scale = 1;
    laid.offset = 0;
  }
  laid.geotransform[0] += (all.first.col - laid.extent.first.col) * laid.geotransform[1];
  laid.geotransform[3] += (all.first.row - laid.extent.first.row) * laid.geotransform[5];
  laid.extent = all;
}

}  // namespace

std::vector<LaidRasters> laid_together(const std::vector<RasterFacts>& rasters, std::vector<std::string>& notes) {
  std::vector<LaidRasters> sets;
  for (const RasterFacts& raster : rasters) {
    const auto takes = [&](const LaidRasters& laid) {
      const RasterFacts& first = laid.members.front();
      return raster.is_placed && first.is_placed && !raster.is_rotated && !first.is_rotated &&
             (raster.crs_wkt == laid.crs_wkt || same_crs(raster.crs_wkt, laid.crs_wkt)) &&
             place_on(laid.mapping, raster).has_value();
    };
    const auto found = std::find_if(sets.begin(), sets.end(), takes);
    if (found == sets.end()) {
      sets.push_back(alone(raster));
    } else {
      found->members.push_back(raster);
      found->members.back().place = *place_on(found->mapping, raster);
    }
  }
  for (LaidRasters& laid : sets) {
    if (laid.members.size() == 1) continue;
    std::vector<GridRect*> places;
    for (RasterFacts& member : laid.members) places.push_back(&member.place);
    const std::vector<std::size_t> moved =
        join_across_antimeridian(places, columns_of_a_turn(laid.crs_wkt, laid.mapping));
    if (!moved.empty()) notes.push_back(note_of_turn(laid.members[moved.front()].name, moved.size()));
    measure_extent(laid);
  }
  return sets;
}

DatasetOwner open_laid(const LaidRasters& laid, GridRect part) {
  GdalScope gdal;
  return DatasetOwner{GDALDataset::ToHandle(new LaidDataset(laid, part))};
}

void rethrow_failure(GDALDatasetH dataset) { static_cast<LaidDataset*>(GDALDataset::FromHandle(dataset))->rethrow(); }

}  // namespace talus
