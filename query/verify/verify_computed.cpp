#include "query/verify/verify_computed.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "engine/geo/ground.hpp"
#include "engine/tile/coarse_levels.hpp"

namespace talus {
namespace {

GridRect square_of(TileId id) { return page_square({1, id.x, id.y}); }
/// The place of a finding about a tile: its square, or its window if the square has no samples.
GridRect place_of(TileId id, GridRect extent) {
  return overlap(square_of(id), extent) ? square_of(id) : tile_window(id, extent);
}

/// Facts that all computations need.
struct Rules {
  const Manifest& manifest;
  const Description& description = manifest.description;
  GridRect extent = description.extent;
  CodeDistance distance{description};
  GroundScale ground = Ground(description.crs).scale_of(description.mapping, extent);
  /// If not all samples were kept: errors up to this one may be stored as 0.
  std::optional<ErrorCode> dropped = description.kept_above().value > 0
                                         ? std::optional(largest_code_within(description.kept_above().value))
                                         : std::nullopt;

  [[nodiscard]] GroundSide side() const {
    return [this](const HalfDiamond& t) { return ground.longest_side(t.a, t.b, t.apex).value; };
  }
  [[nodiscard]] ErrorRule rule() const {
    return {description.error_metric, [this](std::int32_t row) { return ground.cell(row); }};
  }
};

/// The first triangle at p whose bit in `covers` is wrong. Triangles that leave the extent do not count.
template <class Computed>
std::optional<std::size_t> wrong_triangle(const Rules& rules, GridPoint p, std::uint8_t covers,
                                          const Computed& computed) {
  if (spacing(p) == kRootSpacing) return std::nullopt;
  const unsigned wrong = covers ^ computed.covers(p);
  const auto triangles = apex_triangles(p);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const bool is_inside = rules.extent.contains(triangles[t].left) && rules.extent.contains(triangles[t].right);
    if (is_inside && (wrong >> t & 1) != 0) return t;
  }
  return std::nullopt;
}

/// Whether a page, null if it is not stored, has an error as ingest would store it.
/// implied  samples of a dense page whose errors follow from heights
bool has_error(const Rules& rules, const Page* page, std::size_t i, const SquareBits& implied, ErrorCode error) {
  if (page == nullptr) return error == 0;
  const bool is_rounded = page->is_dense && rules.distance.is_whole() && !has(implied, page->in_square(i));
  if (!is_rounded) return page->error(i, rules.distance) == error;
  return page->dense_error(i) == rules.distance.eighths(error_of(error));
}

/// The first difference between a page and error(p), covers(p), height(p), is_data(p) as computed; empty if there is
/// none. A null page is one that is not stored.
template <class Computed>
std::string difference(const Rules& rules, const PageGrid& grid, PageId id, const Page* page,
                       const Computed& computed) {
  std::string found;
  const SquareBits implied = page != nullptr && page->is_dense ? implied_places(data_samples(*page)) : SquareBits{};
  any_sample(grid, [&](std::size_t i, GridPoint p) {
    if (band_of(p, rules.manifest.bands) != id.band) return false;
    const auto at = [&] { return fmt::format("at column {}, row {}", p.col, p.row); };
    ErrorCode error = computed.error(p);
    if (page != nullptr && page->is_sliced() && rules.dropped && error <= *rules.dropped) error = 0;
    const bool is_data = page != nullptr && page->is_data(i);
    const std::uint8_t covers = page == nullptr        ? std::uint8_t{0}
                                : page->covers.empty() ? std::uint8_t{15}
                                                       : page->covers[i];
    if (!has_error(rules, page, i, implied, error)) {
      found = fmt::format("the error {} is {} m, but the samples give {} m", at(),
                          page == nullptr ? 0 : page->error_m(i, rules.distance), error_of(error));
    } else if (is_data != computed.is_data(p)) {
      const char *sample = "a sample", *none = "no data";
      found = fmt::format("{} {}, expected {}", is_data ? sample : none, at(), is_data ? none : sample);
    } else if (const auto t = wrong_triangle(rules, p, covers, computed)) {
      found =
          fmt::format("triangle {} {} is wrongly marked as {}", *t, at(), (covers >> *t & 1) != 0 ? "valid" : "void");
    } else if (covers != 0 && !page->is_dropped(i) && !is_same(page->height(i), computed.height(p))) {
      const HeightStep& step = rules.description.step;
      found = fmt::format("{} {} {}, but {} give {}", is_data ? "height" : "fill", step.value(page->height(i)), at(),
                          is_data ? "records" : "the samples around it", step.value(computed.height(p)));
    }
    return !found.empty();
  });
  return found;
}

// ---- tiles -------------------------------------------------------------------------------------------

class TileChecks {
 public:
  TileChecks(const StoredPages& pages, DecodedPages& decoded, const CheckedPages& of_band_1, Findings& findings,
             VerifyReport& report)
      : pages_(pages), decoded_(decoded), of_band_1_(of_band_1), findings_(findings), report_(report) {
    totals_.lowest = std::numeric_limits<double>::infinity();
    totals_.highest = -totals_.lowest;
  }

  TileTotals run(const std::function<void()>& told) {
    const GridRect tiles = tiles_of(rules_.extent);
    const auto visit = [&](std::uint64_t position) {
      const PageId id = page_at(1, position);
      if (!tiles.contains({id.x, id.y})) findings_.in(id, "its tile has a record, but no samples");
    };
    pages_.transaction().for_each(kRecordTable, visit, [](std::uint64_t, const Failure&) {});  // found with its pages
    for (std::int32_t y = tiles.first.row; y <= tiles.last.row; ++y) {
      for (std::int32_t x = tiles.first.col; x <= tiles.last.col; ++x) {
        check({x, y});
        told();
      }
    }
    return totals_;
  }

 private:
  void check(TileId id) {
    const std::optional<TileSummary> record = record_of(id);
    if (record) add(*record);
    const bool is_read = read(id);
    if (!is_read || !record) return;
    if (rules_.dropped) return check_kept(id, *record);
    const bool is_as_stored = check_pages_of(id);
    const std::vector<std::byte> said = encode(*record);
    if (!is_as_stored || said == encode(summary_of(id))) return;
    // An update may have changed to wider numbers since the tile was computed, so its record may have others.
    for (std::size_t kind = 0; kind < 3; ++kind) {
      if (!compute(id, kind)) continue;
      if (said == encode(summary_of(id))) return;
    }
    find_in_record(id, difference_of(id, *record));
  }

  std::optional<TileSummary> record_of(TileId id) {
    const auto refuse = [&](const std::string& sentence) {
      find_in_record(id, sentence);
      return std::nullopt;
    };
    try {
      const auto stored = pages_.transaction().find({kRecordTable, curve_position({1, id.x, id.y})});
      if (!stored) return refuse("missing");
      ++report_.records;
      TileSummary record = decode_tile_summary(stored->content);
      if (stored->generation != record.entry.generation)
        return refuse(fmt::format("written by update {}, but it says {}", stored->generation, record.entry.generation));
      return record;
    } catch (const Failure& f) {
      if (f.cause() != Cause::corrupt) throw;
      return refuse(f.what());
    }
  }
  void find_in_record(TileId id, const std::string& what) {
    findings_.in(place_of(id, rules_.extent), fmt::format("record of tile {}/{}: {}", id.x, id.y, what));
  }

  void add(const TileSummary& record) {
    totals_.valid_samples += record.valid_samples;
    if (record.valid_samples > 0) {
      totals_.lowest = std::min(totals_.lowest, record.lowest);
      totals_.highest = std::max(totals_.highest, record.highest);
    }
    for (std::size_t i = 0; i < kErrorRungs; ++i) totals_.errors[i] += record.errors[i];
  }

  /// Reads the samples of the tile's window; false if a page cannot be read.
  bool read(TileId id) {
    window_ = tile_window(id, rules_.extent);
    const auto samples = is_empty(window_) ? std::size_t{0} : static_cast<std::size_t>(window_.samples());
    codes_.assign(samples, 0);
    valid_.assign(samples, 0);
    if (samples == 0) return true;
    const PageId first = page_of(window_.first, 0), last = page_of(window_.last, 0);
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      for (std::int32_t x = first.x; x <= last.x; ++x) {
        const DecodedPages::Found found = decoded_.get({0, x, y});
        if (found.is_damaged()) return false;
        if (found.page) copy(*found.page);
      }
    }
    return true;
  }
  void copy(const Page& page) {
    for_each_in(page.grid, window_, [&](std::size_t i, GridPoint p) {
      if (!page.is_data(i)) return;
      codes_[index(p)] = page.height(i);
      valid_[index(p)] = 1;
    });
  }
  [[nodiscard]] std::size_t index(GridPoint p) const { return index_in(window_, p); }

  /// Computes the tile in a kind of numbers; false if that kind cannot hold its samples.
  bool compute(TileId id, std::size_t kind) {
    const auto hold = [&]<class T>(T) {
      std::vector<T> codes(codes_.size());
      for (std::size_t i = 0; i < codes.size(); ++i) {
        constexpr double kLowest = std::numeric_limits<T>::lowest(), kHighest = std::numeric_limits<T>::max();
        if (!(codes_[i] >= kLowest && codes_[i] <= kHighest)) return false;
        codes[i] = static_cast<T>(codes_[i]);
        if (static_cast<double>(codes[i]) != codes_[i]) return false;
      }
      input_ = std::move(codes);
      return true;
    };
    if (!(kind == 0 ? hold(std::int16_t{}) : kind == 1 ? hold(float{}) : hold(double{}))) return false;
    const bool has_voids = std::memchr(valid_.data(), 0, valid_.size()) != nullptr;
    TileInput input;
    input.id = id;
    input.extent = rules_.extent;
    std::visit([&](const auto& codes) { input.heights = std::span(codes); }, input_);
    if (has_voids) input.valid = valid_;
    input.distance = rules_.distance;
    input.ground_side = rules_.side();
    input.void_weight = rules_.description.void_weight;
    input.rule = rules_.rule();
    tile_errors(input, tile_);
    return true;
  }
  /// The kind of numbers that ingest uses for the source's type.
  [[nodiscard]] std::size_t usual_kind() const {
    const std::string& type = rules_.description.source_type;
    return type == "Byte" || type == "Int16" ? 0 : type == "UInt16" || type == "Float32" ? 1 : 2;
  }

  struct OfTile {
    const TileChecks& checks;
    [[nodiscard]] ErrorCode error(GridPoint p) const {
      const TileErrors& t = checks.tile_;
      return t.all_void || !t.errors.holds(p) ? ErrorCode{0} : t.errors[p];
    }
    [[nodiscard]] std::uint8_t covers(GridPoint p) const {
      if (checks.tile_.all_void) return 0;
      return checks.tile_.voids ? checks.tile_.voids->apex_triangles_with_data(p) : std::uint8_t{15};
    }
    [[nodiscard]] bool is_data(GridPoint p) const { return checks.valid_[checks.index(p)] != 0; }
    [[nodiscard]] double height(GridPoint p) const { return code_at(view(checks.tile_.heights), checks.index(p)); }
  };

  /// Whether all pages of bands 0 and 1 of a tile follow from its samples.
  bool check_pages_of(TileId id) {
    if (is_empty(window_)) return true;
    for (std::size_t kind = usual_kind(); !compute(id, kind);) {
      if (++kind < 3) continue;
      findings_.in(place_of(id, rules_.extent), "some heights are not numbers");
      return false;
    }
    return all_pages_of(id, [&](PageId page) { return check_page(page); });
  }
  /// Whether check(page) holds for all pages of bands 0 and 1 of a tile; calls it for each.
  template <class Check>
  static bool all_pages_of(TileId id, Check&& check) {
    const PageId parent{1, id.x, id.y};
    bool all = check(parent);
    for (std::size_t i = 0; i < std::size_t{kChildrenAcross} * kChildrenAcross; ++i)
      all = check(child_page(parent, i)) && all;
    return all;
  }
  bool check_page(PageId id) {
    const PageGrid grid = page_grid(id, rules_.extent);
    if (grid.size() == 0) return true;
    const DecodedPages::Found found = decoded_.get(id);
    if (found.is_damaged()) return false;  // already reported
    const std::string sentence = difference(rules_, grid, id, found.page.get(), OfTile{*this});
    if (sentence.empty()) return true;
    findings_.in(id, found.page ? sentence : "missing: " + sentence);
    return false;
  }

  /// The record as ingest would make it.
  [[nodiscard]] TileSummary summary_of(TileId id) const {
    TileSummary made;
    if (is_empty(window_)) return made;
    made.record = tile_.record;
    constexpr float kNothing = std::numeric_limits<float>::infinity();
    const auto page = of_band_1_.find(curve_position({1, id.x, id.y}));
    made.entry = page != of_band_1_.end() ? page->second.entry : ChildEntry{.lowest = kNothing, .highest = -kNothing};
    if (tile_.all_void) {
      made.entry = {};
      hold_voids(id, made.record);
      return made;
    }
    const GridRect square = square_of(id);
    std::vector<std::uint64_t> by_code(kAlwaysSelected + 1u);
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    const CodeSpan heights = view(tile_.heights);
    for_each_point(common(square, window_), [&](GridPoint p) {
      const std::size_t i = index(p);
      if (valid_[i] != 0) {
        ++made.valid_samples;
        lowest = std::min(lowest, codes_[i]);
        highest = std::max(highest, codes_[i]);
      }
      if (spacing(p) < kBlockSide) {
        ++by_code[tile_.errors[p]];
      } else {
        const auto post = static_cast<std::size_t>((p.row - square.first.row) / kBlockSide * kTileBlocks +
                                                   (p.col - square.first.col) / kBlockSide);
        made.posts[post] = code_at(heights, i);
        made.post_valid[post] = valid_[i];
      }
    });
    if (made.valid_samples > 0) {
      const HeightStep& step = rules_.description.step;
      made.lowest = std::min(step.value(lowest), step.value(highest));
      made.highest = std::max(step.value(lowest), step.value(highest));
    }
    for (std::size_t rung = 0; rung < kErrorRungs; ++rung) {
      for (std::size_t code = largest_code_within(error_rung(rung)) + 1u; code < by_code.size(); ++code)
        made.errors[rung] += by_code[code];
    }
    return made;
  }

  /// The record of a tile without data: all halves inside the extent are void, and no vertex has a fill.
  void hold_voids(TileId id, TileRecord& record) const {
    const GridRect closed = closed_tile(id);
    const auto halves_of = [&](GridPoint p) {
      std::uint8_t holds = 0;
      for (const int side : {0, 1}) {
        const HalfDiamond t = half_diamond(p, side);
        if (inside(t, closed) && inside(t, rules_.extent))
          holds = static_cast<std::uint8_t>(holds | kVoid << (2 * side));
      }
      return holds;
    };
    for (std::int32_t i = 0; i < kTileBlocks * kTileBlocks; ++i) {
      const GridPoint corner{closed.first.col + i % kTileBlocks * kBlockSide,
                             closed.first.row + i / kTileBlocks * kBlockSide};
      record.blocks[static_cast<std::size_t>(i)].holds =
          halves_of({corner.col + kBlockSide / 2, corner.row + kBlockSide / 2});
    }
    for (std::int32_t i = 0; i < TileRecord::kAcross * TileRecord::kAcross; ++i) {
      const GridPoint p{closed.first.col + i % TileRecord::kAcross * kBlockSide,
                        closed.first.row + i / TileRecord::kAcross * kBlockSide};
      if (!rules_.extent.contains(p)) continue;
      record.holds[static_cast<std::size_t>(i)] =
          static_cast<std::uint8_t>(TileRecord::kNoFill | (spacing(p) < kTileSide ? halves_of(p) : 0));
    }
  }

  /// The first difference of a record.
  [[nodiscard]] std::string difference_of(TileId id, const TileSummary& said) {
    compute(id, usual_kind());
    const TileSummary made = summary_of(id);
    for (std::size_t i = 0; i < TileSummary::kPosts; ++i) {
      if (is_same(said.posts[i], made.posts[i]) && said.post_valid[i] == made.post_valid[i]) continue;
      return fmt::format("it has a height of {}, but the page has {}", said.posts[i], made.posts[i]);
    }
    if (!(said.entry == made.entry)) return "it contradicts the tile's page";
    if (said.valid_samples != made.valid_samples)
      return fmt::format("it says {} valid samples, but there are {}", said.valid_samples, made.valid_samples);
    if (said.lowest != made.lowest || said.highest != made.highest)
      return fmt::format("it says heights from {} to {}, but they are from {} to {}", said.lowest, said.highest,
                         made.lowest, made.highest);
    if (said.errors != made.errors) return "its counts of errors differ from those of the tile's pages";
    return "it does not follow from the tile's samples";
  }

  /// Checks a record if not all samples were kept: only against the pages.
  void check_kept(TileId id, const TileSummary& said) {
    const auto refuse = [&](const std::string& what) { find_in_record(id, what); };
    const auto page = of_band_1_.find(curve_position({1, id.x, id.y}));
    const bool is_stored = page != of_band_1_.end();
    if (is_stored && !page->second.is_readable) return;
    if (said.entry.present != is_stored) return refuse("it contradicts the tile's page");
    if (is_stored) {
      const ChildEntry& made = page->second.entry;
      if (said.entry.largest != made.largest || said.entry.generation != made.generation ||
          said.entry.lowest > made.lowest || said.entry.highest < made.highest)
        return refuse("it contradicts the tile's page");
    }
    const GridRect square = square_of(id);
    std::uint64_t valid = 0;
    for_each_point(common(square, window_), [&](GridPoint p) { valid += valid_[index(p)]; });
    if (valid != said.valid_samples)
      return refuse(fmt::format("it says {} valid samples, but there are {}", said.valid_samples, valid));
    check_kept_counts(id, said, refuse);
  }
  template <class Refuse>
  void check_kept_counts(TileId id, const TileSummary& said, Refuse&& refuse) {
    std::vector<std::uint64_t> by_code(kAlwaysSelected + 1u);
    const auto count = [&](PageId page_id) {
      const DecodedPages::Found found = decoded_.get(page_id);
      if (!found.page) return !found.is_damaged();
      const Page& page = *found.page;
      for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
        if (page.is_own(p)) ++by_code[page.error(i, rules_.distance)];
      });
      return true;
    };
    if (!all_pages_of(id, count)) return;
    for (std::size_t rung = 0; rung < kErrorRungs; ++rung) {
      const ErrorCode within = largest_code_within(error_rung(rung));
      if (within < *rules_.dropped) continue;
      std::uint64_t above = 0;
      for (std::size_t code = within + 1u; code < by_code.size(); ++code) above += by_code[code];
      if (above != said.errors[rung]) return refuse("its counts of errors differ from those of the tile's pages");
    }
  }

  const StoredPages& pages_;
  Rules rules_{pages_.manifest()};
  DecodedPages& decoded_;
  const CheckedPages& of_band_1_;
  Findings& findings_;
  VerifyReport& report_;
  TileTotals totals_;
  GridRect window_{{0, 0}, {-1, -1}};
  std::vector<double> codes_;
  std::vector<std::uint8_t> valid_;
  Codes input_;
  TileErrors tile_;
};

// ---- coarse levels -----------------------------------------------------------------------------------

struct OfLevels {
  const CoarseLevels& levels;
  [[nodiscard]] ErrorCode error(GridPoint p) const { return levels.error(p); }
  [[nodiscard]] std::uint8_t covers(GridPoint p) const {
    return height_in_tree(p) >= levels.root_height() || !levels.has_voids() ? std::uint8_t{15}
                                                                            : levels.apex_triangles_with_data(p);
  }
  [[nodiscard]] bool is_data(GridPoint p) const { return levels.is_valid(p); }
  [[nodiscard]] double height(GridPoint p) const { return levels.height(p); }
};

}  // namespace

TileTotals check_tiles(const StoredPages& pages, DecodedPages& decoded, const CheckedPages& of_band_1,
                       Findings& findings, VerifyReport& report, const std::function<void()>& told) {
  return TileChecks(pages, decoded, of_band_1, findings, report).run(told);
}

std::uint64_t tiles_in(GridRect extent) { return static_cast<std::uint64_t>(tiles_of(extent).samples()); }

void check_coarse(const StoredPages& pages, DecodedPages& decoded, Findings& findings) {
  const Rules rules{pages.manifest()};
  const ReadTxn& txn = pages.transaction();
  CoarseLevels levels(rules.extent, rules.distance, rules.side(), rules.description.void_weight, rules.rule());
  const ForEachTile tiles = [&](const auto& visit) {
    txn.for_each(kRecordTable, [&](std::uint64_t position) {
      const PageId id = page_at(1, position);
      visit({id.x, id.y}, decode_tile_summary(txn.find({kRecordTable, position})->content));
      txn.forget({kRecordTable, position});
    });
  };
  DecodedPages::Found held;
  const ReadBack read_back = [&](PageId id) -> const Page* {
    held = decoded.get(id);
    return held.page.get();
  };
  levels.settle(tiles, rules.dropped ? ReadBack() : read_back);
  for (int band = kFewestBands - 1; band < rules.manifest.bands; ++band) {
    for (const PageId id : pages_of_band(band, rules.extent)) {
      const DecodedPages::Found found = decoded.get(id);
      if (found.is_damaged()) continue;
      const std::string sentence =
          difference(rules, page_grid(id, rules.extent), id, found.page.get(), OfLevels{levels});
      if (!sentence.empty()) findings.in(id, found.page ? sentence : "missing: " + sentence);
    }
  }
}

}  // namespace talus
