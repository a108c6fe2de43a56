#pragma once
// Stage two of ingest: the vertices of spacing kBlockSide or more (1/4096 of all), in memory, from the tile records.
//
// A half-diamond of spacing 64 to 512 lies in one tile and was measured there. Larger ones are measured here: the plane
// of each block bounds the distance of its samples, and only blocks that can have the largest one are read again.

#include <functional>
#include <unordered_map>
#include <vector>

#include "engine/tile/tile_summary.hpp"

namespace talus {

/// Calls visit(tile, summary) for every tile with a summary, always in the same order.
using ForEachTile = std::function<void(const std::function<void(TileId, const TileSummary&)>&)>;
/// A page of band 0 with its heights, valid until the next call; null: it is not stored, so it holds voids only. An
/// empty function: pages do not have all heights, so the bound of a plane counts as the distance.
using ReadBack = std::function<const Page*(PageId)>;

class CoarseLevels {
 public:
  /// Memory: about 40 bytes for each 64² samples of the extent.
  CoarseLevels(GridRect extent, const CodeDistance& distance, GroundSide ground_side, double void_weight,
               ErrorRule rule = {});
  ~CoarseLevels();

  /// Reads all tile summaries, measures what is larger than a tile, and saturates.
  void settle(const ForEachTile& tiles, const ReadBack& read_back);

  // Vertices on every 64th sample of the extent:
  [[nodiscard]] ErrorCode error(GridPoint p) const;  ///< saturated error
  [[nodiscard]] double height(GridPoint p) const { return posts_[post(p)]; }
  [[nodiscard]] bool is_valid(GridPoint p) const { return post_valid_[post(p)] != 0; }
  [[nodiscard]] bool has_voids() const { return has_voids_; }
  /// log2 of the root's side, which is the height in the tree of its corners.
  [[nodiscard]] int root_height() const { return errors_.levels() + kBlockShift; }
  /// See VoidMap::apex_triangles_with_data.
  [[nodiscard]] std::uint8_t apex_triangles_with_data(GridPoint p) const;
  /// Number of pages that settle() read back.
  [[nodiscard]] std::uint64_t pages_read_back() const { return pages_read_back_; }

 private:
  struct Large;  // a half-diamond larger than a tile

  void take(TileId id, const TileSummary& summary);
  void hold_large_halves();
  void fill_far_voids();
  void measure_large(const ForEachTile& tiles, const ReadBack& read_back);
  void collect_large();
  void bound_in(TileId id, const TileSummary& summary);
  void look_in(TileId id, const TileSummary& summary, const ReadBack& read_back);
  void look(Large& half, const Page& page, GridRect block) const;
  template <class Visit>
  void for_each_large_touching(TileId id, Visit&& visit);
  void saturate();
  [[nodiscard]] ErrorCode below(int shift, bool centres, GridPoint unit) const;
  [[nodiscard]] bool is_exactly_zero(GridPoint unit) const;
  [[nodiscard]] Holds half(GridPoint unit, int side) const;
  [[nodiscard]] Holds triangle(Triangle in_samples) const;

  [[nodiscard]] std::size_t post(GridPoint p) const;
  [[nodiscard]] std::size_t block(std::int32_t x, std::int32_t y) const;
  [[nodiscard]] bool has_block(std::int32_t x, std::int32_t y) const;

  GridRect extent_;
  GridRect units_;   ///< posts inside the extent, in units of kBlockSide; empty: none
  GridRect blocks_;  ///< blocks that touch the extent, and one more on every side
  CodeDistance distance_;
  GroundSide ground_side_;
  double void_weight_;
  ErrorRule rule_;
  bool has_voids_ = false;
  LevelGrid<ErrorCode> errors_;    ///< in units
  LevelGrid<std::uint8_t> holds_;  ///< in units; side 0 | side 1 << 2
  std::vector<ErrorCode> block_errors_;
  std::vector<std::uint8_t> block_holds_;
  std::vector<double> posts_;
  std::vector<std::uint8_t> post_valid_;
  std::vector<std::pair<GridPoint, double>> typical_;  ///< typical heights of blocks with data
  std::vector<GridPoint> without_fill_;                ///< in units
  std::vector<Large> large_;
  int smallest_shift_ = kTileShift - kBlockShift;  ///< log2 of the smallest spacing in large_, in units
  std::unordered_map<std::uint64_t, std::size_t> large_at_;
  std::uint64_t pages_read_back_ = 0;
};

}  // namespace talus
