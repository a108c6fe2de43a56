#include "ingest/job/job.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>

#include "engine/geo/ground.hpp"
#include "engine/machine/fail.hpp"
#include "engine/machine/parallel.hpp"
#include "engine/tile/coarse_levels.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/job/stored_bytes.hpp"
#include "ingest/job/thread_pool.hpp"
#include "ingest/mosaic/common_grid.hpp"

namespace talus {
namespace {

using Clock = std::chrono::steady_clock;

/// Share of the time spent on tiles. The rest goes into the levels above them and the seal.
constexpr double kTileShare = 0.97;

class ProgressReporter {
 public:
  ProgressReporter(const Job& job, std::uint64_t samples_before) : job_(job), before_(samples_before) {}

  void beginning(const char* stage) { report(stage, 0, 0); }
  void tiles(std::uint64_t samples) {
    report("tiles", kTileShare * static_cast<double>(samples) / static_cast<double>(all()), samples);
  }
  void rest(const char* stage, double fraction) { report(stage, fraction, all()); }

 private:
  [[nodiscard]] std::uint64_t all() const { return static_cast<std::uint64_t>(job_.description.extent.samples()); }
  void report(const char* stage, double fraction, std::uint64_t samples) {
    if (!job_.options.progress) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - job_.started).count();
    const double before = kTileShare * static_cast<double>(before_) / static_cast<double>(all());
    const double left = fraction > before + 0.005 ? seconds * (1 - fraction) / (fraction - before) : -1;
    job_.options.progress({fraction, stage, samples, all(), seconds, left, before_});
  }

  const Job& job_;
  std::uint64_t before_;  // samples that an interrupted ingest has finished
};

/// The result of a future. While it is not ready, progress is reported, which may throw.
template <class Result>
Result wait_for(std::future<Result>& future, ProgressReporter& progress, std::uint64_t samples) {
  while (future.wait_for(std::chrono::milliseconds(200)) != std::future_status::ready) progress.tiles(samples);
  return future.get();
}

// ---- stage one: tiles ------------------------------------------------------------------------------

/// Memory for computing a tile. It is kept for the next tile, because fresh memory costs more than filling it.
struct TileMemory {
  Window window;
  TileErrors errors;
  TilePacking packing;
};

ErrorRule rule_of(const Job& job) {
  return {job.description.error_metric, [&job](std::int32_t row) { return job.ground.cell(row); }};
}

TilePages compute_tile(const Job& job, TileId id, const Window& panel, TileMemory& memory) {
  const GridRect part = tile_window(id, job.description.extent);
  if (is_empty(part)) return {};
  Window& window = memory.window;
  cut(panel, part, window);
  TileInput input;
  input.id = id;
  input.extent = job.description.extent;
  std::visit([&](const auto& codes) { input.heights = std::span(codes); }, window.codes);
  input.valid = window.valid;
  input.distance = job.distance;
  input.ground_side = [&](const HalfDiamond& t) { return job.ground.longest_side(t.a, t.b, t.apex).value; };
  input.void_weight = job.description.void_weight;
  input.rule = rule_of(job);
  tile_errors(input, memory.errors);
  return pack_tile(id, memory.errors, window.valid, job.making, memory.packing);
}

PageKey record_key(TileId id) { return {kRecordTable, curve_position({1, id.x, id.y})}; }
TileId tile_at(std::uint64_t position) {
  const PageId id = page_at(1, position);
  return {id.x, id.y};
}

std::uint64_t own_samples(TileId id, GridRect extent) {
  const GridRect own = common(square({id.x * kTileSide, id.y * kTileSide}, kTileSide), extent);
  return is_empty(own) ? 0 : static_cast<std::uint64_t>(own.samples());
}

void put(PageWriter& writer, TileId id, const TilePages& tile, std::uint64_t& pages) {
  for (const PageBytes& page : tile.pages) writer.put(page.key, page.content, page.generation);
  if (tile.slice) writer.put(tile.slice->key, tile.slice->content, tile.slice->generation);
  pages += tile.pages.size();
  writer.put(record_key(id), encode(tile.summary), tile.summary.entry.generation);
  writer.commit();
}

/// Computes one panel while the next is read. Results are written in order, so that the file does not depend on the
/// number of threads.
void compute_tiles(const Job& job, PageWriter& writer, IngestReport& report) {
  std::vector<Panel> panels = panels_of(job.description.extent, job.budget.tiles_across);
  std::uint64_t computed = 0;
  {
    const ReadTxn done = writer.committed();
    for (Panel& panel : panels) {
      std::erase_if(panel.tiles, [&](TileId id) {
        const bool keep = done.has(record_key(id)) && !job.is_stale(id);
        if (keep) computed += own_samples(id, job.description.extent);
        return keep;
      });
    }
  }
  std::erase_if(panels, [](const Panel& panel) { return panel.tiles.empty(); });
  if (panels.empty()) return;
  const std::uint64_t computed_before = computed;
  ProgressReporter progress(job, computed);
  progress.tiles(computed);

  PanelReader reader(job.read);
  std::deque<TileMemory> memories(job.budget.threads);
  ThreadPool crew(job.budget.threads);  // ends before the memory that its work uses
  const auto read = [&](std::size_t i) { return crew.give([&, i](unsigned) { return &reader.read(panels[i]); }); };
  auto next = read(0);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Window& panel = *wait_for(next, progress, computed);
    if (i + 1 < panels.size()) next = read(i + 1);
    job.files->require_unchanged(panels[i].window);  // before a tile of this panel is written
    std::deque<std::future<TilePages>> under_way;
    const std::vector<TileId>& tiles = panels[i].tiles;
    for (std::size_t done = 0, given = 0; done < tiles.size(); ++done) {
      for (; given < tiles.size() && under_way.size() < 2 * job.budget.threads; ++given) {
        under_way.push_back(
            crew.give([&, id = tiles[given]](unsigned who) { return compute_tile(job, id, panel, memories[who]); }));
      }
      const TilePages tile = wait_for(under_way.front(), progress, computed);
      under_way.pop_front();
      put(writer, tiles[done], tile, report.pages);
      ++report.tiles;
      computed += own_samples(tiles[done], job.description.extent);
      progress.tiles(computed);
    }
  }
  report.samples = computed - computed_before;
}

// ---- stage two: what is larger than a tile -----------------------------------------------------------

struct Totals {
  std::uint64_t valid = 0;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  ErrorHistogram errors{};
  std::unordered_map<std::uint64_t, ChildEntry> entries;  ///< child entries of band 1

  void add(TileId id, const TileSummary& summary) {
    valid += summary.valid_samples;
    if (summary.valid_samples > 0) {
      lowest = std::min(lowest, summary.lowest);
      highest = std::max(highest, summary.highest);
    }
    for (std::size_t i = 0; i < errors.size(); ++i) errors[i] += summary.errors[i];
    if (summary.entry.present) entries.emplace(curve_position({1, id.x, id.y}), summary.entry);
  }
};

/// Computes the levels above tiles. Their pages are collected: the file must not change while it is read.
Totals compute_coarse(const Job& job, PageWriter& writer, IngestReport& report, std::vector<PageBytes>& pages) {
  const ReadTxn view = writer.view();
  Totals totals;
  const GroundSide ground = [&](const HalfDiamond& t) { return job.ground.longest_side(t.a, t.b, t.apex).value; };
  CoarseLevels levels(job.description.extent, job.distance, ground, job.description.void_weight, rule_of(job));
  const ForEachTile tiles = [&](const auto& visit) {
    view.for_each(kRecordTable, [&](std::uint64_t position) {
      const auto stored = view.find({kRecordTable, position});
      visit(tile_at(position), decode_tile_summary(stored->content));
      view.forget({kRecordTable, position});
    });
  };
  tiles([&](TileId id, const TileSummary& summary) { totals.add(id, summary); });
  PageDecoder decoder;
  const ReadBack read_back = [&](PageId id) -> const Page* {
    const PageKey key{id.band, curve_position(id)};
    const auto stored = view.find(key);
    if (!stored) return nullptr;
    const Page& page = decoder.decode_heights(id, job.description.extent, job.making.bands, job.distance,
                                              stored->content, content_in(view));
    view.require_all_bytes();
    view.forget(key);
    return &page;
  };
  if (totals.valid == 0) return totals;
  levels.settle(tiles, job.making.kept_above > 0 ? ReadBack() : read_back);
  report.pages_read_back = levels.pages_read_back();
  pack_coarse(levels, totals.entries, job.making, [&](PageBytes page) { pages.push_back(std::move(page)); });
  return totals;
}

std::vector<std::uint32_t> top_generations(const Job& job, const std::vector<PageBytes>& pages) {
  std::vector<std::uint32_t> tops;
  for (const PageId id : pages_of_band(job.making.bands - 1, job.description.extent)) {
    const PageKey key{id.band, curve_position(id)};
    const auto found = std::find_if(pages.begin(), pages.end(), [&](const PageBytes& p) { return p.key == key; });
    tops.push_back(found == pages.end() ? 0 : found->generation);
  }
  return tops;
}

void finish(Job& job, PageWriter& writer, const Totals& totals, const std::vector<PageBytes>& pages,
            Provenance provenance) {
  Description& d = job.description;
  const auto all = static_cast<std::uint64_t>(d.extent.samples());
  d.void_samples = all - totals.valid;
  d.minimum_height = totals.lowest;
  d.maximum_height = totals.highest;
  for (const PageBytes& page : pages) writer.put(page.key, page.content, page.generation);
  const Manifest manifest{d, job.making.bands, provenance.generation, top_generations(job, pages)};
  provenance.vertices_above.clear();  // counts of the generation before
  for (std::size_t i = 0; i < kErrorRungs; ++i) provenance.vertices_above.emplace_back(error_rung(i), totals.errors[i]);
  writer.put({kHeaderTable, kPlanPosition}, {}, provenance.generation);  // nothing is left to resume
  writer.put({kHeaderTable, kProvenancePosition}, encode(provenance), provenance.generation);
  writer.put({kHeaderTable, kManifestPosition}, encode(manifest), provenance.generation);
}

std::string seam_note(const SeamReport& seams) {
  if (seams.different == 0) return "";
  return fmt::format(
      "where inputs overlap, {} of {} samples differ. The largest difference is {} m at {}, {}, where {} covers {}",
      seams.different, seams.compared, seams.largest_m, seams.x, seams.y, seams.covering, seams.covered);
}

void require_sense(const IngestOptions& options) {
  if (!(options.void_weight >= 0) || options.void_weight > 1e6)
    refuse("void weight {}: expected a number from 0 to 1000000", options.void_weight);
  if (options.finest_tolerance.value > 0 && options.error_metric != ErrorMetric::vertical) {
    refuse(
        "a finest tolerance leaves out heights that vertical errors vouch for: it does not go with the perpendicular "
        "metric");
  }
  const double coarsest = 1e6;
  if (!(options.finest_tolerance.value >= 0) || options.finest_tolerance.value > coarsest)
    refuse("finest tolerance {} m: expected 0 to {} m", options.finest_tolerance.value, coarsest);
  if (options.finest_tolerance.value > 0 && options.finest_tolerance.value <= options.inputs.height_step.value / 2) {
    refuse("finest tolerance {} m: heights rounded to multiples of {} m are up to {} m off. Choose a larger tolerance",
           options.finest_tolerance.value, options.inputs.height_step.value, options.inputs.height_step.value / 2);
  }
}

}  // namespace

Job job_of(const Description& description, std::size_t bytes_a_code, std::uint64_t block_bytes, ReadWindow read,
           const IngestOptions& options) {
  require_sense(options);
  Job job{options,
          description,
          std::move(read),
          {},
          {},
          nullptr,
          Ground(description.crs).scale_of(description.mapping, description.extent),
          {},
          {}};
  const Description& d = job.description;
  job.is_stale = [](TileId) { return false; };
  job.distance = CodeDistance(d);
  job.making = {d.extent,
                d.step,
                job.distance,
                band_count(d.extent),
                d.kept_above().value,
                std::make_shared<const ExtentBorder>(d.extent),
                [](PageKey, std::span<const std::byte>) { return 0u; }};
  job.budget = budget_for(options.memory_bytes, threads_or_all(options.threads), d.extent, bytes_a_code, block_bytes);
  return job;
}

void tell_of(const Job& job, const char* stage) { ProgressReporter(job, 0).beginning(stage); }

IngestEstimate estimate(const Job& job, const Source& source, const std::function<bool(TileId)>& is_wanted) {
  IngestEstimate sum;
  sum.description = job.description;
  sum.threads = static_cast<int>(job.budget.threads);
  std::vector<TileId> tiles;
  for (const Panel& panel : panels_of(job.description.extent, 1)) {
    for (const TileId id : panel.tiles) {
      if (is_wanted(id)) tiles.push_back(id);
    }
  }
  sum.tiles = tiles.size();
  constexpr std::size_t kTried = 5;
  const std::size_t tried = std::min(kTried, tiles.size());
  double samples = 0, seconds = 0, bytes = 0, all = 0;
  for (const TileId id : tiles) all += static_cast<double>(own_samples(id, job.description.extent));
  Window read;
  TileMemory memory;
  for (std::size_t i = 0; i < tried; ++i) {
    const TileId id = tiles[(2 * i + 1) * tiles.size() / (2 * tried)];
    const auto begun = Clock::now();
    const GridRect window = tile_window(id, job.description.extent);
    job.read(read, window, window);
    const TilePages tile = compute_tile(job, id, read, memory);
    seconds += std::chrono::duration<double>(Clock::now() - begun).count();
    samples += static_cast<double>(own_samples(id, job.description.extent));
    for (const PageBytes& page : tile.pages) bytes += static_cast<double>(page.content.size());
    if (tile.slice) bytes += static_cast<double>(tile.slice->content.size());
    bytes += static_cast<double>(encode(tile.summary).size());
  }
  if (samples > 0) {
    constexpr double kFixed = 40e3, kAround = 1.02;  // headers and trees; coarse levels and LMDB's own pages
    sum.bytes = static_cast<std::uint64_t>(kFixed + bytes / samples * all * kAround);
    sum.seconds = seconds / samples * all / job.budget.threads;
  }
  sum.notes = source.notes();
  return sum;
}

IngestReport run(Job& job, const Source& source, Provenance provenance, PageWriter& writer) {
  const RasterCache cache(job.budget.gdal_cache_bytes);
  IngestReport report;
  compute_tiles(job, writer, report);
  ProgressReporter progress(job, 0);
  progress.rest("levels above tiles", kTileShare);
  std::vector<PageBytes> coarse;
  const Totals totals = compute_coarse(job, writer, report, coarse);
  if (totals.valid == 0) {
    refuse("{}: all {} samples are void; there is nothing to ingest", job.description.source_name,
           job.description.extent.samples());
  }
  report.pages += coarse.size();
  progress.rest("checking that the inputs are unchanged", 0.98);
  job.files->require_unchanged([&] { progress.rest("checking that the inputs are unchanged", 0.98); });
  for (std::size_t i = 0; i < source.inputs().size(); ++i) {
    const InputFile& input = source.inputs()[i];
    provenance.sources.push_back(
        {input.name, input.driver, input.type, input.cols, input.rows, input.bytes, job.files->checksum(i)});
  }
  finish(job, writer, totals, coarse, std::move(provenance));
  progress.rest("sealing", 0.99);
  report.bytes = writer.finish();
  progress.rest("done", 1);
  report.description = job.description;
  report.notes = source.notes();
  if (const std::string seams = seam_note(source.seams()); !seams.empty()) report.notes.push_back(seams);
  for (std::string& doubt : source.doubts(report.description.minimum_height, report.description.maximum_height))
    report.notes.push_back(std::move(doubt));
  return report;
}

}  // namespace talus
