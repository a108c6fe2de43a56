#include "query/selection/range_query.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <type_traits>

#include "engine/dense/kernels.hpp"
#include "engine/machine/fail.hpp"
#include "engine/machine/parallel.hpp"
#include "engine/quadtree/border.hpp"
#include "query/pages/page_descent.hpp"
#include "query/pages/page_fates.hpp"
#include "query/pages/stopwatch.hpp"
#include "query/selection/answer_builder.hpp"
#include "query/selection/refusals.hpp"
#include "query/selection/square_in_mask.hpp"
#include "query/selection/threshold.hpp"

namespace talus {
namespace {

/// A page to be read.
struct Wanted {
  PageId id;
  std::uint32_t generation;
  bool is_above;  ///< it may have errors above the tolerance; otherwise only the border needs it
};

class RangeQuery {
 public:
  RangeQuery(const StoredPages& pages, GridRect region, Metres tolerance, int threads, std::optional<Metres> from,
             Watch& watch)
      : pages_(pages),
        watch_(watch),
        region_(region),
        asked_(tolerance),
        threads_(region.samples() < kWorthThreads ? 1 : std::max(1, threads)) {
    if (from) above_from_.emplace(left_of(*from), pages.distance());
    for (int i = 0; i < threads_; ++i) workers_.push_back(std::make_unique<Worker>(pages, region, threads_));
  }

  Answer run() {
    const auto started = std::chrono::steady_clock::now();
    force_border();
    workers_.front()->fates.begin();
    std::vector<Wanted> pages;
    for_each_top(manifest_, region_, [&](PageId top, std::uint32_t generation) {
      pages.push_back({top, generation, true});
      area_ += area_of(top);
    });
    // One thread reads the coarsest pages, until there are enough tasks for all threads.
    const std::size_t enough = threads_ == 1 ? 0 : kTasksAThread * static_cast<std::size_t>(threads_);
    while (!pages.empty() && pages.size() < enough && pages.front().id.band > 0) {
      std::vector<Wanted> below;
      for (const Wanted& page : pages) look_into(page, *workers_.front(), below);
      pages = std::move(below);
    }
    for_each_task(threads_, pages.size(),
                  [&](int who, std::size_t task) { descend(pages[task], *workers_[static_cast<std::size_t>(who)]); });
    watch_.look();
    return answer(started);
  }

 private:
  static constexpr std::int64_t kWorthThreads = 1 << 20;  ///< samples
  static constexpr std::size_t kTasksAThread = 8;
  /// Share of a tile in the region from which on its slice is read. It takes as long as 40 of the tile's 64 pages.
  static constexpr double kWorthSlice = 0.75;
  /// Tolerance over threshold up to which a slice is read. Beyond it takes several times as long as the few pages that it
  /// replaces, and saves no bytes (docs/decisions/0014-slices.md).
  static constexpr double kReachOfSlice = 16;
  static constexpr std::size_t kChildren = std::size_t{kChildrenAcross} * kChildrenAcross;

  struct NothingNeeded {
    bool operator()(std::size_t) const { return false; }
  };

  using PageKeyPair = std::pair<int, std::uint64_t>;

  /// The results and the working memory of one thread.
  struct Worker {
    Worker(const StoredPages& pages, GridRect region, int workers)
        : fates(pages, region, cost),
          found(pages, cost, expected_bytes(region, workers)),
          levels(pages.manifest().description.extent),
          decoder(pages.borrow_decoder()) {}
    /// 16 bytes for each vertex, if one sample in eight is a vertex; at most 2 MiB.
    static std::size_t expected_bytes(GridRect region, int workers) {
      return static_cast<std::size_t>(std::clamp<std::int64_t>(2 * region.samples() / workers, 1 << 16, 2 << 20));
    }
    QueryCost cost;
    PageFates fates;
    AnswerBuilder found;
    LargestAbsent absent;
    LargestByLevel levels;
    std::uint64_t forced_alone = 0;
    PageCache::BorrowedDecoder decoder;
    Array<PageSample> chosen;
    std::vector<std::uint8_t> is_forced;  ///< 1 for each sample of a page that the border needs
    std::vector<std::uint32_t> chosen_of_slice, forced_of_slice;
    std::vector<GridPoint> points_of_slice;
    SquareBits selected{}, coarser{};  ///< of a dense page
    detail::SortedSquare errors;       ///< of a dense page, without those that the border needs
  };

  /// The samples of the region in a page's square. The areas of all child pages add up to that of their parent page.
  [[nodiscard]] std::int64_t area_of(PageId id) const {
    const GridRect part = common(page_square(id), region_);
    return is_empty(part) ? 0 : part.samples();
  }

  /// The tolerance for stored heights, in metres: less the loss, and at least kept_above().
  [[nodiscard]] double left_of(Metres asked) const {
    return std::max(manifest_.description.kept_above().value, asked.value - manifest_.description.lossy.value);
  }

  Answer answer(std::chrono::steady_clock::time_point started) {
    LargestAbsent absent;
    LargestByLevel levels(manifest_.description.extent);
    std::vector<const AnswerBuilder*> found;
    Answer answer;
    answer.cost = pages_.cost_of_header();
    for (const auto& worker : workers_) {
      absent.take(worker->absent);
      levels.take(worker->levels);
      found.push_back(&worker->found);
      answer.border_vertices += worker->forced_alone;
    }
    {
      const Stopwatch gathering(answer.cost.gathering_seconds);
      answer.quadtree = AnswerBuilder::quadtree(found, region_, std::move(vertices_), threads_);
    }
    answer.quadtree.tolerance = asked_;
    answer.quadtree.bound = bound_of(pages_, absent, tolerance_);
    answer.quadtree.level_errors = levels.metres(pages_);
    answer.quadtree.origin = {pages_.identity(), Border::constrain, true};
    for (const auto& worker : workers_) answer.cost += worker->cost;
    answer.cost.reading_seconds /= threads_;
    answer.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return answer;
  }

  /// Lists by page the vertices that the border needs. All pages above are in the list, too.
  void force_border() {
    for (const GridPoint p : border_vertices(region_, root_side(manifest_.description.extent))) {
      PageId id = page_of(p, band_of(p, manifest_.bands));
      forced_[{id.band, curve_position(id)}].push_back(p);
      for (id = parent_page(id); id.band < manifest_.bands; id = parent_page(id)) {
        if (!forced_.try_emplace({id.band, curve_position(id)}).second) break;
      }
    }
  }
  [[nodiscard]] bool is_forced(PageId id) const { return forced_.contains({id.band, curve_position(id)}); }

  void descend(const Wanted& wanted, Worker& worker) {
    std::vector<Wanted> below;
    look_into(wanted, worker, below);
    for (const Wanted& page : below) descend(page, worker);
  }

  /// Reads a page, selects its vertices, and adds to `below` the child pages to be read.
  void look_into(const Wanted& wanted, Worker& worker, std::vector<Wanted>& below) {
    watch_.look();
    std::int64_t settled = area_of(wanted.id);
    const TileSlice* slice = slice_for(wanted, worker);
    if (slice != nullptr && has_all_forced(wanted.id, worker)) {
      worker.fates.replace(wanted.id);
      select(
          *slice, wanted.id, [](GridPoint) { return true; }, worker);
      return settle(settled, worker);
    }
    std::shared_ptr<const Page> kept;
    if (keeps_pages_) kept = pages_.shared(wanted.id, wanted.generation, worker.cost);
    const Page& page = kept ? *kept : pages_.get(wanted.id, wanted.generation, worker.decoder->pages, worker.cost);
    worker.fates.look_into(page, wanted.is_above);
    select(page, worker);
    std::uint64_t replaced = 0;  // child pages, by curve position: a page of band 1 has 64
    for_each_child(page, region_, [&](PageId child, const ChildEntry& entry) {
      // If the child page has no error above the tolerance, its child entry counts for the bound, even if the border
      // needs the page. An increment does not read such a page, and this way it has the same bound.
      const bool is_wanted = above_(entry.largest);
      if (!is_wanted) worker.absent.code = std::max(worker.absent.code, entry.largest);
      if (slice != nullptr && is_wanted && !is_forced(child)) {
        worker.fates.replace(child);
        replaced |= std::uint64_t{1} << (curve_position(child) % kChildren);
        return;
      }
      if (!is_wanted && (above_from_ || !is_forced(child))) return;
      below.push_back({child, entry.generation, is_wanted});
      settled -= area_of(child);
    });
    if (replaced != 0) {
      const auto is_replaced = [&](GridPoint p) {
        return band_of(p, manifest_.bands) == 0 && (replaced >> (curve_position(page_of(p, 0)) % kChildren) & 1) != 0;
      };
      select(*slice, wanted.id, is_replaced, worker);
    }
    settle(settled, worker);
  }

  /// Whether the slice decoded last has all vertices of its tile that the border needs. They are then listed in
  /// `forced_of_slice`; otherwise that is empty.
  [[nodiscard]] bool has_all_forced(PageId tile, Worker& worker) const {
    const SliceCoder& slices = worker.decoder->slices;
    std::vector<std::uint32_t>& places = worker.forced_of_slice;
    places.clear();
    if (!is_forced(tile)) return true;
    bool has_all = true;
    const auto look = [&](PageId id) {
      const auto found = forced_.find({id.band, curve_position(id)});
      if (found == forced_.end()) return;
      for (const GridPoint p : found->second) {
        places.push_back(place_in_tile(p));
        // A slice may have vertices of pages that are not stored. The border does not need those: they have no triangles.
        has_all = has_all && slices.has(places.back()) && slices.covers_at(places.back()) != 0;
      }
    };
    look(tile);
    for (std::size_t i = 0; has_all && i < kChildren; ++i) look(child_page(tile, i));
    if (!has_all) places.clear();
    std::sort(places.begin(), places.end());
    return has_all;
  }

  void settle(std::int64_t samples, Worker& worker) {
    const std::int64_t done = settled_.fetch_add(samples, std::memory_order_relaxed) + samples;
    if (&worker == workers_.front().get()) watch_.tell(static_cast<double>(done) / static_cast<double>(area_));
  }

  /// The slice of the tile of a page of band 1, if it is worth its time and has all vertices above the tolerance. Of
  /// those that the border needs it may lack some. If the database keeps the vertices of a tolerance, a tile with a slice
  /// has nothing else.
  [[nodiscard]] const TileSlice* slice_for(const Wanted& wanted, Worker& worker) const {
    if (wanted.id.band != 1 || !wanted.is_above) return nullptr;
    const GridRect tile = common(page_square(wanted.id), manifest_.description.extent);
    if (is_empty(tile) || static_cast<double>(area_of(wanted.id)) < kWorthSlice * static_cast<double>(tile.samples()))
      return nullptr;
    const auto threshold = pages_.threshold_of_slice(wanted.id);
    if (worker.found.all_are_kept() ? threshold && !is_in_reach(*threshold) : !threshold) return nullptr;
    return &pages_.slice(wanted.id, wanted.generation, worker.decoder->slices, worker.cost);
  }
  /// Whether a slice with this threshold has all vertices above the tolerance, and not far more.
  [[nodiscard]] bool is_in_reach(std::int32_t threshold) const {
    if (threshold == kNoSlice || threshold > above_.counted()) return false;
    const CodeDistance& distance = pages_.distance();
    const auto metres = [&](std::int32_t counted) {
      return distance.is_whole() ? distance.metres(counted / 8.0) : error_of(static_cast<ErrorCode>(counted));
    };
    return threshold == 0 || metres(above_.counted()) <= kReachOfSlice * metres(threshold);
  }

  /// Selects the vertices of a slice that lie in the region, for which `has` holds, and that are above the tolerance or
  /// needed by the border. All others, and those that the slice lacks, count as absent.
  template <class Has>
  void select(const TileSlice& slice, PageId tile, Has&& has, Worker& worker) {
    const GridPoint corner = page_square(tile).first;
    const CodeDistance& distance = pages_.distance();
    worker.absent.take(slice.above, distance);
    worker.chosen_of_slice.clear();
    worker.points_of_slice.clear();
    for (std::uint32_t i = 0; i < slice.size(); ++i) {
      const GridPoint p = point_at(corner, slice.places[i]);
      if (!region_.contains(p) || !has(p)) continue;
      const std::int32_t error = slice.errors[i];
      const std::vector<std::uint32_t>& forced = worker.forced_of_slice;
      const bool is_forced = std::binary_search(forced.begin(), forced.end(), slice.places[i]);
      const bool is_above = error > above_.counted();
      if (!is_above && !is_forced) worker.absent.take(error, distance);
      if (above_from_ ? !is_above || is_forced || error > above_from_->counted() : !is_above && !is_forced) continue;
      if (!is_forced) {
        worker.levels.take(error, p, distance);
      } else if (!is_above) {
        ++worker.forced_alone;
      }
      worker.chosen_of_slice.push_back(i);
      worker.points_of_slice.push_back(p);
    }
    watch_.add_vertices(worker.chosen_of_slice.size());
    for (const GridPoint p : worker.points_of_slice) {
      std::uint64_t& word = vertices_.row_words(p.row)[static_cast<std::size_t>(p.col - region_.first.col) / 64];
      const std::uint64_t bit = std::uint64_t{1} << static_cast<std::size_t>(p.col - region_.first.col) % 64;
      std::atomic_ref(word).fetch_or(bit, std::memory_order_relaxed);
    }
    worker.found.take(slice, worker.chosen_of_slice, worker.points_of_slice);
  }

  /// Selects the page's own vertices that are above the tolerance or that the border needs. An increment leaves out
  /// those that the border needs or that the coarser answer has.
  void select(const Page& page, Worker& worker) {
    const auto found = forced_.find({page.id.band, curve_position(page.id)});
    const std::span<const GridPoint> forced =
        found == forced_.end() ? std::span<const GridPoint>() : std::span<const GridPoint>(found->second);
    if (page.is_dense) return select_dense(page, forced, worker);
    if (forced.empty()) {
      above_from_ ? choose<true>(page, worker, NothingNeeded()) : choose<false>(page, worker, NothingNeeded());
      for (const auto [col, row] : worker.chosen)
        worker.levels.take(page, page.index(col, row), page.grid.at(col, row), pages_.distance());
    } else {
      select_beside_border(page, forced, worker);
    }
    watch_.add_vertices(worker.chosen.size());
    insert(page.grid, worker.chosen);
    worker.found.take(page, worker.chosen);
  }

  /// The same for a dense page: whole words of bits instead of samples.
  void select_dense(const Page& page, std::span<const GridPoint> forced, Worker& worker) {
    const GridPoint first = page_square(page.id).first;
    const GridRect part = common(region_, page_square(page.id));
    const detail::SquarePart of_square{part.first.col - first.col, part.last.col - first.col,
                                       part.first.row - first.row, part.last.row - first.row};
    const detail::SortedSquare* errors = &page.squares.front().errors;
    if (!forced.empty()) {  // they count neither as absent nor for levels
      worker.errors = *errors;
      for (const GridPoint p : forced)
        worker.errors.numbers[detail::SortedSquare::index_of(p.col - first.col, p.row - first.row)] = -1;
      errors = &worker.errors;
    }
    const auto select = [&](const Threshold& above, SquareBits& bits) {
      constexpr std::int32_t kMost = std::numeric_limits<std::int16_t>::max();
      return kernel_.select(*errors, static_cast<std::int16_t>(std::min(above.eighths(), kMost)), of_square,
                            bits.data());
    };
    SquareBits& bits = worker.selected;
    const detail::EighthsFound found = select(above_, bits);
    worker.absent.distance = std::max(worker.absent.distance, found.largest_absent / 8.0);
    if (above_from_) {
      select(*above_from_, worker.coarser);
      remove_coarser(page, worker);
      select_coded(page, *errors, of_square, worker);
    } else {
      select_coded(page, *errors, of_square, worker);
      for (int level = 0; level < kBandLevels; ++level)
        worker.levels.take(level, found.largest_selected[level], pages_.distance());
      for (const GridPoint p : forced) {
        talus::insert(bits, p.col - first.col, p.row - first.row);
        if (!above_(page, page.index(p))) ++worker.forced_alone;
      }
    }
    take_selected(page, first, worker);
  }

  /// Takes what the coarser answer has out of what is selected. The largest errors of levels are then those of the
  /// rest.
  void remove_coarser(const Page& page, Worker& worker) const {
    worker.selected = without(worker.selected, worker.coarser);
    std::array<std::int16_t, kBandLevels> largest;
    largest.fill(-1);
    for_each_bit(worker.selected, [&](int col, int row) {
      std::int16_t& of_level = largest[static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(col | row)))];
      of_level = std::max(of_level, page.squares.front().errors.numbers[detail::SortedSquare::index_of(col, row)]);
    });
    for (int level = 0; level < kBandLevels; ++level)
      worker.levels.take(level, largest[static_cast<std::size_t>(level)], pages_.distance());
  }

  /// The same for vertices of a dense page whose errors are codes.
  void select_coded(const Page& page, const detail::SortedSquare& errors, const detail::SquarePart& part,
                    Worker& worker) const {
    for (const int place : page.coded) {
      const int col = place % kPageSide, row = place / kPageSide;
      if (col < part.first_col || col > part.last_col || row < part.first_row || row > part.last_row) continue;
      const auto error = static_cast<ErrorCode>(-1 - errors.numbers[detail::SortedSquare::index_of(col, row)]);
      if (error <= above_.code()) {
        worker.absent.code = std::max(worker.absent.code, error);
      } else if (!above_from_ || error <= above_from_->code()) {
        talus::insert(worker.selected, col, row);
        worker.levels.take(error, {col, row}, pages_.distance());
      }
    }
  }

  void take_selected(const Page& page, GridPoint first, Worker& worker) {
    watch_.add_vertices(count(worker.selected));
    insert_square(worker.selected, first, threads_ > 1, vertices_);
    if (page.valid.empty() && page.covers.empty() && worker.found.all_are_kept()) {
      // All pages above were read before, so their vertices in this square are in the mask.
      worker.found.take(page, square_of(vertices_, first, threads_ > 1));
      return;
    }
    worker.chosen.clear();
    for_each_bit(worker.selected, [&](int col, int row) {
      const GridPoint at = page.grid.local({first.col + col, first.row + row});
      worker.chosen.push_back({static_cast<std::uint16_t>(at.col), static_cast<std::uint16_t>(at.row)});
    });
    worker.found.take(page, worker.chosen);
  }

  void select_beside_border(const Page& page, std::span<const GridPoint> forced, Worker& worker) {
    std::vector<std::uint8_t>& is_forced = worker.is_forced;
    is_forced.assign(page.grid.size(), 0);
    for (const GridPoint p : forced) is_forced[page.index(p)] = 1;
    const auto is_needed = [&](std::size_t i) { return is_forced[i] != 0; };
    above_from_ ? choose<true>(page, worker, is_needed) : choose<false>(page, worker, is_needed);
    for (const auto [col, row] : worker.chosen) {
      const std::size_t i = page.index(col, row);
      if (is_forced[i] == 0) {
        worker.levels.take(page, i, page.grid.at(col, row), pages_.distance());
      } else if (!above_(page, i)) {
        ++worker.forced_alone;
      }
    }
  }

  /// Lists in `chosen` the samples above the tolerance and those that are needed. All others count as absent. An
  /// increment lists only samples that are above the tolerance, within the coarser tolerance, and not needed.
  template <bool kIsIncrement, class IsNeeded>
  void choose(const Page& page, Worker& worker, IsNeeded&& is_needed) {
    const auto samples = samples_in(page.grid, region_);
    const auto first = samples.first, last = samples.last;
    worker.chosen.resize(page.grid.size() + 1);
    PageSample* next = worker.chosen.data();
    const ErrorCode threshold = above_.code(), threshold_before = kIsIncrement ? above_from_->code() : ErrorCode{0};
    ErrorCode absent_code = worker.absent.code;
    // Tests for each sample whether its distance or its code is above the tolerance. Samples of other bands have
    // neither. The loop writes each sample, then keeps or overwrites it: a branch would be hard to predict.
    const auto look = [&](auto&& distance_of, auto largest_within, auto largest_before) {
      auto largest_absent = largest_within;
      largest_absent = -1;
      for (std::int32_t row = first.row; row <= last.row; ++row) {
        for (std::int32_t col = first.col; col <= last.col; ++col) {
          const std::size_t i = page.index(col, row);
          const ErrorCode code = page.errors[i];
          const auto distance = distance_of(i);
          const bool is_above = (distance > largest_within) | (code > threshold), needed = is_needed(i);
          const bool is_absent = !(is_above | needed);
          bool is_chosen = !is_absent;
          if (kIsIncrement) is_chosen = is_above & !((distance > largest_before) | (code > threshold_before) | needed);
          *next = {static_cast<std::uint16_t>(col), static_cast<std::uint16_t>(row)};
          next += is_chosen ? 1 : 0;
          absent_code = std::max(absent_code, is_absent ? code : ErrorCode{0});
          largest_absent = std::max(largest_absent, is_absent ? distance : decltype(distance)(-1));
        }
      }
      return static_cast<double>(largest_absent);
    };
    double absent = -1;
    if (!page.eighths.empty()) {
      absent = look([&](std::size_t i) { return page.eighths[i]; }, above_.eighths(),
                    kIsIncrement ? above_from_->eighths() : 0) /
               8;
    } else if (!page.distances.empty()) {
      absent = look([&](std::size_t i) { return page.distances[i]; }, above_.distance(),
                    kIsIncrement ? above_from_->distance() : 0.0);
    } else {
      look([](std::size_t) { return -1; }, 0, 0);
    }
    worker.chosen.resize(static_cast<std::size_t>(next - worker.chosen.data()));
    worker.absent.code = absent_code;
    worker.absent.distance = std::max(worker.absent.distance, absent);
  }

  /// Writes each word atomically: other threads may write other bits of it at the same time.
  void insert(const PageGrid& grid, std::span<const PageSample> samples) {
    std::uint64_t* word = nullptr;
    std::uint64_t bits = 0;
    const auto flush = [&] {
      if (bits != 0) std::atomic_ref(*word).fetch_or(bits, std::memory_order_relaxed);
    };
    std::span<std::uint64_t> words;
    int row_of_words = -1;
    for (const auto [col, row] : samples) {
      const GridPoint p = grid.at(col, row);
      if (row != row_of_words) {
        words = vertices_.row_words(p.row);
        row_of_words = row;
      }
      const auto at = static_cast<std::size_t>(std::int64_t{p.col} - region_.first.col);
      std::uint64_t* here = &words[at / 64];
      if (here != word) {
        flush();
        word = here;
        bits = 0;
      }
      bits |= std::uint64_t{1} << at % 64;
    }
    flush();
  }

  const StoredPages& pages_;
  Watch& watch_;
  const Manifest& manifest_ = pages_.manifest();
  GridRect region_;
  Metres asked_;
  double tolerance_ = left_of(asked_);  ///< for stored heights, in metres
  int threads_;
  const detail::EighthsKernel& kernel_ = detail::eighths_kernel(instruction_set());
  bool keeps_pages_ = pages_.would_keep(region_);  ///< the cache keeps them for the next question
  Threshold above_{tolerance_, pages_.distance()};
  std::optional<Threshold> above_from_;  ///< for an increment: selects the coarser answer
  VertexMask vertices_{region_};
  std::map<PageKeyPair, std::vector<GridPoint>> forced_;  ///< by page, the vertices that the border needs
  std::vector<std::unique_ptr<Worker>> workers_;
  std::int64_t area_ = 1;  ///< samples of the region; `settled_` of them are done
  std::atomic<std::int64_t> settled_ = 0;
};

void copy_samples(const Page& page, const HeightStep& step, StoredSamples& stored) {
  SampleWindow& to = stored.window;
  for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
    if (!to.region.contains(p) || !page.is_data(i)) return;
    to.values[to.index(p)] = step.value(page.height(i));
    to.valid[to.index(p)] = 1;
    if (page.is_dropped(i)) stored.dropped[to.index(p)] = 1;
  });
}

}  // namespace

Answer range_query(const StoredPages& pages, GridRect region, Metres tolerance, int threads, std::optional<Metres> from,
                   Watch& watch) {
  require_inside(pages, region);
  require_tolerance(tolerance);
  watch.add_bytes(bytes_of_mask(region));
  Answer answer = RangeQuery(pages, region, tolerance, threads, from, watch).run();
  answer.from = from;
  return answer;
}

SampleWindow all_samples(const StoredPages& pages, GridRect region, Watch& watch) {
  if (const double finest = pages.manifest().description.finest_tolerance.value; finest > 0) {
    fail(Cause::unsupported,
         "the database keeps only the vertices of answers at {} m and more: it cannot restore samples; ask for a "
         "surface at that tolerance",
         finest);
  }
  return stored_samples(pages, region, watch).window;
}

StoredSamples stored_samples(const StoredPages& pages, GridRect region, Watch& watch) {
  require_inside(pages, region);
  StoredSamples stored;
  SampleWindow& window = stored.window;
  window.region = region;
  window.values.assign(static_cast<std::size_t>(region.samples()), 0);
  window.valid.assign(window.values.size(), 0);
  if (pages.manifest().description.finest_tolerance.value > 0) stored.dropped.assign(window.values.size(), 0);
  const HeightStep& step = pages.manifest().description.step;
  QueryCost unused;
  PageDecoder decoder;
  const auto visit = [&](auto&& self, PageId id, std::uint32_t generation) -> void {
    watch.look();
    const Page& page = pages.get_heights(id, generation, decoder, unused);
    if (id.band == 0) return copy_samples(page, step, stored);
    const std::vector<ChildEntry> children = page.children;  // the decoder's next page replaces this one
    for_each_child(id, children, region,
                   [&](PageId child, const ChildEntry& entry) { self(self, child, entry.generation); });
  };
  for_each_top(pages.manifest(), region, [&](PageId top, std::uint32_t generation) { visit(visit, top, generation); });
  return stored;
}

}  // namespace talus
