#include "ingest/mosaic/source.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/machine/large_memory.hpp"
#include "engine/quadtree/rect.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "ingest/files/input_list.hpp"
#include "ingest/files/raster_guard.hpp"
#include "ingest/mosaic/common_grid.hpp"
#include "ingest/mosaic/placement.hpp"
#include "ingest/mosaic/resampled_rasters.hpp"
#include "ingest/mosaic/void_doubts.hpp"
#include "ingest/raster/crs.hpp"
#include "ingest/raster/open_rasters.hpp"
#include "ingest/raster/raster_facts.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// Adds the part of `rect` that no piece has. Pieces do not overlap.
void add_piece(std::vector<GridRect>& pieces, GridRect rect, std::size_t from = 0) {
  for (std::size_t i = from; i < pieces.size(); ++i) {
    const GridRect p = pieces[i];
    if (!overlap(p, rect)) continue;
    const GridRect c = common(p, rect);
    if (rect.first.row < c.first.row) add_piece(pieces, {rect.first, {rect.last.col, c.first.row - 1}}, i + 1);
    if (rect.last.row > c.last.row) add_piece(pieces, {{rect.first.col, c.last.row + 1}, rect.last}, i + 1);
    if (rect.first.col < c.first.col) {
      add_piece(pieces, {{rect.first.col, c.first.row}, {c.first.col - 1, c.last.row}}, i + 1);
    }
    if (rect.last.col > c.last.col) {
      add_piece(pieces, {{c.last.col + 1, c.first.row}, {rect.last.col, c.last.row}}, i + 1);
    }
    return;
  }
  pieces.push_back(rect);
}

// ---- types and steps ---------------------------------------------------------------------------------

enum class Width { int16, float32, float64 };

Width width_of(GDALDataType type) {
  switch (type) {
    case GDT_Byte:
    case GDT_Int16: return Width::int16;
    case GDT_UInt16:
    case GDT_Float32: return Width::float32;
    default: return Width::float64;
  }
}

const char* name_of(Width width) {
  return width == Width::int16 ? "Int16" : width == Width::float32 ? "Float32" : "Float64";
}

struct Types {
  Width width = Width::int16;
  RasterCoding::Rule rule = RasterCoding::Rule::raw;
  HeightStep step;
  std::string source_type;
};

HeightStep forced_step(double metres, double metres_per_unit) {
  if (!std::isfinite(metres) || metres < 1e-6 || metres > kLargestHeight)
    refuse("InputOptions::height_step {}: expected metres from 0.000001 to {}", metres, kLargestHeight);
  const double units = metres / metres_per_unit, parts = std::round(1 / units);
  // A step of 0.1 divides codes by ten: heights are then the doubles nearest to their decimals.
  if (units < 1 && std::abs(units * parts - 1) < 1e-12) return {1, parts, 0, true};
  return {units, 1, 0, true};
}

bool has_step(const RasterFacts& raster, const HeightStep& step) {
  return raster.is_integer() && step == HeightStep{raster.scale, 1, raster.offset, true};
}

bool is_bare(const RasterFacts& raster) { return raster.scale == 1 && raster.offset == 0; }

Types types_of(const std::vector<RasterFacts>& rasters, const InputOptions& options) {
  Types types;
  const RasterFacts& first = rasters.front();
  std::set<std::string> names;
  for (const RasterFacts& raster : rasters) {
    types.width = std::max(types.width, width_of(raster.read_type()));
    names.insert(GDALGetDataTypeName(raster.read_type()));
  }
  const std::optional<HeightStep> wanted = options.grid ? options.grid->step : std::nullopt;
  const HeightStep of_first{first.scale, 1, first.offset, true};
  const auto all_have = [&](const HeightStep& step) {
    return std::all_of(rasters.begin(), rasters.end(), [&](const RasterFacts& r) { return has_step(r, step); });
  };
  if (options.height_step.value != 0) {
    types.rule = RasterCoding::Rule::rounded;
    types.step = forced_step(options.height_step.value, first.metres_per_unit);
    const bool all_bare = std::all_of(rasters.begin(), rasters.end(), is_bare);
    if (options.height_step.value < 1 || !all_bare) types.width = std::max(types.width, Width::float32);
    if (!all_bare || kLargestHeight / options.height_step.value > double{1 << 24}) types.width = Width::float64;
  } else if (wanted ? wanted->integer && all_have(*wanted) : all_have(of_first)) {
    types.step = wanted.value_or(of_first);
  } else {
    types.step = {1, 1, 0, false};
    types.rule = RasterCoding::Rule::value;
    if (std::all_of(rasters.begin(), rasters.end(), is_bare)) {
      types.rule = RasterCoding::Rule::raw;
      types.width = std::max(types.width, Width::float32);
    } else {
      types.width = Width::float64;
    }
  }
  if (wanted && !(types.step == *wanted)) {
    fail(Cause::unsupported,
         "the database stores heights in {}, which cannot represent those of the inputs. Ingest all inputs into a new "
         "database",
         wanted->integer ? "whole steps" : "the source's own numbers");
  }
  types.source_type = names.size() == 1 ? *names.begin() : name_of(types.width);
  return types;
}

template <class T>
void resize(Codes& codes, std::size_t samples) {
  if (!std::holds_alternative<std::vector<T>>(codes)) codes.emplace<std::vector<T>>();
  make_room(std::get<std::vector<T>>(codes), samples);
  std::get<std::vector<T>>(codes).resize(samples);
}

void resize(Codes& codes, Width width, std::size_t samples) {
  if (width == Width::int16) return resize<std::int16_t>(codes, samples);
  if (width == Width::float32) return resize<float>(codes, samples);
  return resize<double>(codes, samples);
}

// ---- inputs and layers -------------------------------------------------------------------------------

std::string name_of(const std::vector<RasterFacts>& rasters) {
  return name_of_all(fs::path(rasters.front().name).filename().string(), rasters.size());
}

/// Adds each different note once, with the inputs it is about.
void gather_notes(const std::vector<RasterFacts>& rasters, std::vector<std::string>& notes) {
  std::vector<std::pair<std::string, std::vector<const RasterFacts*>>> kinds;
  std::map<std::string, std::size_t> kind_of;
  for (const RasterFacts& raster : rasters) {
    for (const std::string& note : raster.notes) {
      const auto [kind, is_new] = kind_of.try_emplace(note, kinds.size());
      if (is_new) kinds.push_back({note, {}});
      kinds[kind->second].second.push_back(&raster);
    }
  }
  for (const auto& [note, whose] : kinds) {
    notes.push_back(name_of_all(whose.front()->name, whose.size()) + ": " + note);
  }
  std::map<std::string, std::size_t> voids;
  for (const RasterFacts& raster : rasters) ++voids[raster.void_text.empty() ? "nothing" : raster.void_text];
  if (voids.size() < 2) return;
  std::string text;
  for (const auto& [value, count] : voids) {
    text += fmt::format("{}{} in {}", text.empty() ? "" : ", ", value, count == 1 ? "one" : std::to_string(count));
  }
  notes.push_back("inputs mark voids in different ways: " + text);
}

InputFile as_input(const RasterFacts& raster) {
  InputFile input;
  input.name = fs::path(raster.name).filename().string();
  input.driver = raster.driver;
  input.type = GDALGetDataTypeName(raster.type);
  input.cols = raster.cols;
  input.rows = raster.rows;
  input.bytes = raster.bytes;
  input.files = raster.files;
  input.void_value = raster.void_text;
  input.is_resampled = raster.warp.has_value();
  input.place = raster.place;
  input.notes = raster.notes;
  return input;
}

/// Samples on the common grid per sample of the raster: below 1 if the raster is finer.
double cell_area(const RasterFacts& raster) {
  return static_cast<double>(raster.place.samples()) / raster.cols / raster.rows;
}

/// Inputs in the order in which they are laid, the last on top.
std::vector<std::size_t> order_of(const std::vector<RasterFacts>& rasters, bool finer_on_top) {
  std::vector<std::size_t> order(rasters.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  constexpr double kAlike = 1e-3;  // smaller differences of ln(area) are rounding
  const auto size_class = [&](std::size_t i) { return std::llround(std::log(cell_area(rasters[i])) / kAlike); };
  if (finer_on_top) {
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return size_class(a) > size_class(b); });
  }
  return order;
}

/// Heights saved before another raster is laid over them.
template <class T>
struct Kept {
  GridRect region;
  std::vector<T> codes;
  std::vector<std::uint8_t> valid;  // empty: all are valid
};

/// A raster at one place. It has several layers if it meets the grid at several full turns of longitude.
struct Layer {
  std::size_t raster;
  GridRect place;
  std::int32_t east;  // columns from the raster's first place

  [[nodiscard]] GridRect in_raster(GridRect part) const {
    return {{part.first.col - east, part.first.row}, {part.last.col - east, part.last.row}};
  }
};

std::vector<Layer> layers_of(const std::vector<RasterFacts>& rasters, bool finer_on_top) {
  std::vector<Layer> layers;
  for (const std::size_t i : order_of(rasters, finer_on_top)) {
    const GridRect& place = rasters[i].place;
    layers.push_back({i, place, 0});
    for (const std::int32_t east : rasters[i].also_east)
      layers.push_back({i, {{place.first.col + east, place.first.row}, {place.last.col + east, place.last.row}}, east});
  }
  return layers;
}

}  // namespace

/// All facts of the inputs, shared by the readers.
struct Source::Plan {
  Description description;
  Types types;
  std::vector<RasterFacts> rasters;
  std::vector<Layer> layers;  // the last is on top
  std::vector<InputFile> inputs;
  std::vector<std::string> notes;
  InputOptions options;
};

struct Source::Reader {
  explicit Reader(const Plan& p) : plan(p), open(p.rasters) {}

  const Plan& plan;
  mutable OpenRasters open;
  mutable ResampledRasters resampled;
  mutable std::uint64_t compared = 0, different = 0;
  mutable double largest_m = 0;
  mutable GridPoint at{};
  mutable std::size_t covering = 0;  // the top layer at `at`
  mutable ZeroEdges zero_edges;

  template <class T>
  void lay(std::size_t layer, Window& window, std::vector<T>& codes, GridRect own) const;
  template <class T>
  void restore(const Kept<T>& kept, Window& window, std::vector<T>& codes, GridRect own, std::size_t layer) const;
  void note_difference(GridPoint p, double metres, std::size_t layer) const;
  /// As RasterSource::read; `part` is on the common grid, within the layer's place.
  template <class T>
  bool read(const Layer& layer, GridRect part, T* codes, std::size_t stride,
            const std::function<std::uint8_t*()>& valid) const;
  [[nodiscard]] std::optional<double> height_at(const Layer& layer, GridPoint p) const;
};

namespace {

void set_all_valid(Window& window, GridRect rect) {
  for (std::int32_t row = rect.first.row; row <= rect.last.row; ++row) {
    const auto to = window.valid.begin() + static_cast<std::ptrdiff_t>(index_in(window.region, {rect.first.col, row}));
    std::fill_n(to, rect.cols(), std::uint8_t{1});
  }
}

template <class T>
Kept<T> keep(const Window& window, const std::vector<T>& codes, GridRect rect) {
  Kept<T> kept{rect, {}, {}};
  kept.codes.reserve(static_cast<std::size_t>(rect.samples()));
  for (std::int32_t row = rect.first.row; row <= rect.last.row; ++row) {
    const auto from = static_cast<std::ptrdiff_t>(index_in(window.region, {rect.first.col, row}));
    kept.codes.insert(kept.codes.end(), codes.begin() + from, codes.begin() + from + rect.cols());
    if (window.valid.empty()) continue;
    kept.valid.insert(kept.valid.end(), window.valid.begin() + from, window.valid.begin() + from + rect.cols());
  }
  return kept;
}

}  // namespace

void Source::Reader::note_difference(GridPoint p, double metres, std::size_t layer) const {
  const bool is_first = different++ == 0;
  const bool is_earlier = p.row < at.row || (p.row == at.row && p.col < at.col);
  if (!is_first && (metres < largest_m || (metres == largest_m && !is_earlier))) return;
  largest_m = metres;
  at = p;
  covering = layer;
}

template <class T>
bool Source::Reader::read(const Layer& layer, GridRect part, T* codes, std::size_t stride,
                          const std::function<std::uint8_t*()>& valid) const {
  const RasterFacts& facts = plan.rasters[layer.raster];
  const RasterCoding coding{plan.types.rule, plan.types.step};
  if (!facts.warp) return open.get(layer.raster).read(layer.in_raster(part), coding, codes, stride, valid);
  resampled.read(facts, layer.in_raster(part), coding, codes, stride, valid);
  return true;
}

/// Restores earlier heights where the new raster is void, and compares heights where both are valid.
template <class T>
void Source::Reader::restore(const Kept<T>& kept, Window& window, std::vector<T>& codes, GridRect own,
                             std::size_t layer) const {
  const HeightStep& step = plan.types.step;
  std::size_t i = 0;
  for (std::int32_t row = kept.region.first.row; row <= kept.region.last.row; ++row) {
    std::size_t to = index_in(window.region, {kept.region.first.col, row});
    for (std::int32_t col = kept.region.first.col; col <= kept.region.last.col; ++col, ++i, ++to) {
      if (!kept.valid.empty() && kept.valid[i] == 0) continue;
      if (!window.valid.empty() && window.valid[to] == 0) {
        codes[to] = kept.codes[i];
        window.valid[to] = 1;
      } else if (own.contains({col, row})) {
        ++compared;
        if (kept.codes[i] == codes[to]) continue;
        const double difference =
            step.value(static_cast<double>(kept.codes[i])) - step.value(static_cast<double>(codes[to]));
        note_difference({col, row}, std::abs(difference) * plan.description.metres_per_unit, layer);
      }
    }
  }
}

template <class T>
void Source::Reader::lay(std::size_t layer, Window& window, std::vector<T>& codes, GridRect own) const {
  const Layer& laid = plan.layers[layer];
  const GridRect rect = common(laid.place, window.region);
  std::vector<GridRect> overlaps;
  for (std::size_t below = 0; below < layer; ++below) {
    const GridRect other = plan.layers[below].place;
    if (overlap(other, rect)) add_piece(overlaps, common(other, rect));
  }
  std::vector<Kept<T>> kept;
  for (const GridRect& both : overlaps) kept.push_back(keep(window, codes, both));

  const std::size_t at_first = index_in(window.region, rect.first);
  const auto valid_at = [&] {
    const auto samples = static_cast<std::size_t>(window.region.samples());
    if (window.valid.empty()) {
      make_room(window.valid, samples);
      window.valid.assign(samples, 1);
    }
    return window.valid.data() + at_first;
  };
  const bool may_be_void =
      read(laid, rect, codes.data() + at_first, static_cast<std::size_t>(window.region.cols()), valid_at);
  if (!may_be_void && !window.valid.empty()) set_all_valid(window, rect);
  for (const Kept<T>& k : kept) restore(k, window, codes, own, layer);
}

Source::Source(const std::vector<fs::path>& inputs, const InputOptions& options) {
  InputList list = list_inputs(inputs, options);
  const auto made = std::make_shared<Plan>();
  Plan& plan = *made;
  plan.notes = std::move(list.notes);
  plan.options = options;
  std::vector<std::string> broken;
  for (const fs::path& file : list.files) {
    AdmittedRaster input;
    try {
      input = open_input(file, options);
    } catch (const Failure& f) {
      if (!options.skip_broken || f.cause() == Cause::invalid_argument) throw;
      broken.push_back(f.what());
      continue;
    }
    plan.rasters.push_back(look_at(std::move(input), file, options));
  }
  if (plan.rasters.empty())
    fail_in(list.files.front(), Cause::unsupported, "no input can be opened; the first: {}", broken.front());
  for (const std::string& why : broken) plan.notes.push_back("left out: " + why);
  const bool is_taken = std::any_of(plan.rasters.begin(), plan.rasters.end(),
                                    [](const RasterFacts& raster) { return !raster.assumed_voids.empty(); });
  const bool only_nan =
      std::all_of(options.nodata.begin(), options.nodata.end(), [](double value) { return std::isnan(value); });
  if (!only_nan && !is_taken) {
    plan.notes.push_back(
        "InputOptions::nodata makes no sample void: every input declares a void value of its own or cannot hold this "
        "one (gdal_translate -a_nodata changes what a file declares)");
  }

  const Placement placement = place_on_one_grid(plan.rasters, options);
  plan.types = types_of(plan.rasters, options);
  plan.layers = layers_of(plan.rasters, options.priority_resolution);
  gather_notes(plan.rasters, plan.notes);
  plan.notes.insert(plan.notes.end(), placement.notes.begin(), placement.notes.end());
  for (const RasterFacts& raster : plan.rasters) plan.inputs.push_back(as_input(raster));

  Description& d = plan.description;
  d.extent = placement.extent;
  d.mapping = placement.mapping;
  d.crs_wkt = placement.crs_wkt;
  d.crs = facts_of_crs(d.crs_wkt);
  d.source_name = name_of(plan.rasters);
  d.source_type = plan.types.source_type;
  d.vertical_unit = plan.rasters.front().vertical_unit;
  d.metres_per_unit = plan.rasters.front().metres_per_unit;
  d.step = plan.types.step;
  plan_ = made;
  reader_ = std::make_unique<Reader>(*plan_);
}

Source Source::clone() const {
  Source other;
  other.plan_ = plan_;
  other.reader_ = std::make_unique<Reader>(*plan_);
  return other;
}

Source::Source() = default;
Source::~Source() = default;
Source::Source(Source&&) noexcept = default;
Source& Source::operator=(Source&&) noexcept = default;

const Description& Source::description() const { return plan_->description; }
const std::vector<InputFile>& Source::inputs() const { return plan_->inputs; }
const std::vector<std::string>& Source::notes() const { return plan_->notes; }

Window Source::read(GridRect part, GridRect own) const {
  Window window;
  read_into(window, part, own);
  return window;
}

void Source::read_into(Window& window, GridRect part, GridRect own) const {
  const GridRect& extent = plan_->description.extent;
  if (is_empty(part) || !extent.contains(part.first) || !extent.contains(part.last)) {
    refuse("columns {} to {}, rows {} to {} are not a part of {}, which has columns {} to {}, rows {} to {}",
           part.first.col, part.last.col, part.first.row, part.last.row, plan_->description.source_name,
           extent.first.col, extent.last.col, extent.first.row, extent.last.row);
  }
  const auto samples = static_cast<std::size_t>(part.samples());
  window.region = part;
  resize(window.codes, plan_->types.width, samples);
  window.valid.clear();
  std::vector<GridRect> covered;
  for (const Layer& layer : plan_->layers) {
    if (overlap(layer.place, part)) add_piece(covered, common(layer.place, part));
  }
  std::int64_t area = 0;
  for (const GridRect& piece : covered) area += piece.samples();
  if (area < part.samples()) {
    window.valid.assign(samples, 0);
    std::visit([](auto& codes) { std::fill(codes.begin(), codes.end(), 0); }, window.codes);
  }

  for (std::size_t layer = 0; layer < plan_->layers.size(); ++layer) {
    if (!overlap(plan_->layers[layer].place, part)) continue;
    std::visit([&](auto& codes) { reader_->lay(layer, window, codes, own); }, window.codes);
  }
  if (!window.valid.empty() && std::memchr(window.valid.data(), 0, window.valid.size()) == nullptr) {
    window.valid.clear();
  }
  const HeightStep& step = plan_->types.step;
  if (!step.integer || step.offset == 0) {
    const double scale = step.integer ? step.scale / step.divisor : 1;
    count_zero_edges(window, common(own, part), scale * plan_->description.metres_per_unit, reader_->zero_edges);
  }
}

bool Source::touches(GridRect part) const {
  return std::any_of(plan_->layers.begin(), plan_->layers.end(),
                     [&](const Layer& layer) { return overlap(layer.place, part); });
}

std::uint64_t Source::block_bytes() const {
  std::uint64_t largest = 0;
  for (const RasterFacts& raster : plan_->rasters) largest = std::max(largest, raster.block_bytes);
  return largest;
}

std::optional<double> Source::Reader::height_at(const Layer& layer, GridPoint p) const {
  if (!layer.place.contains(p)) return std::nullopt;
  Codes codes;
  resize(codes, plan.types.width, 1);
  return std::visit(
      [&](auto& one) -> std::optional<double> {
        std::uint8_t valid = 1;
        read(layer, {p, p}, one.data(), 1, [&] { return &valid; });
        if (valid == 0) return std::nullopt;
        return plan.types.step.value(static_cast<double>(one.front()));
      },
      codes);
}

SeamReport Source::seams() const {
  const Reader& reader = *reader_;
  const Plan& plan = *plan_;
  SeamReport report;
  report.compared = reader.compared;
  report.different = reader.different;
  if (report.different == 0) return report;
  report.largest_m = reader.largest_m;
  report.at = reader.at;
  report.x = plan.description.mapping.x(report.at.col);
  report.y = plan.description.mapping.y(report.at.row);
  report.covering = plan.inputs[plan.layers[reader.covering].raster].name;
  for (std::size_t below = reader.covering; below-- > 0 && report.covered.empty();) {
    const Layer& layer = plan.layers[below];
    if (reader.height_at(layer, report.at)) report.covered = plan.inputs[layer.raster].name;
  }
  return report;
}

std::vector<std::string> Source::doubts(double minimum, double maximum) const {
  const bool all_declare = std::all_of(plan_->rasters.begin(), plan_->rasters.end(), [](const RasterFacts& raster) {
    // The user's value would have to be a raw sample.
    return raster.nodata.has_value() || (!is_bare(raster) && raster.decode == ColourCode::none);
  });
  return void_doubts(minimum, maximum, reader_->zero_edges, plan_->description.vertical_unit, all_declare);
}

SeamReport joined(const SeamReport& a, const SeamReport& b) {
  const auto is_earlier = [](GridPoint p, GridPoint q) { return p.row < q.row || (p.row == q.row && p.col < q.col); };
  const bool b_leads = a.different == 0 || b.largest_m > a.largest_m ||
                       (b.different != 0 && b.largest_m == a.largest_m && is_earlier(b.at, a.at));
  SeamReport both = b_leads ? b : a;
  both.compared = a.compared + b.compared;
  both.different = a.different + b.different;
  return both;
}

std::vector<FileState> Source::files_now(std::size_t input) const {
  return admit_raster(plan_->rasters.at(input).file, plan_->options).files;
}

Grid grid_of(const Description& d) {
  return {d.mapping, d.extent, d.crs_wkt, d.vertical_unit, d.metres_per_unit, d.step};
}

}  // namespace talus
