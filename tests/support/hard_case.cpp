#include "tests/support/hard_case.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/machine/instruction_set.hpp"
#include "engine/stream/stream_codec.hpp"
#include "talus/ingest.hpp"
#include "tests/support/float_exceptions.hpp"
#include "tests/support/forced_kernel.hpp"
#include "tests/support/quadtrees.hpp"

namespace talus::support {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSmallest = std::numeric_limits<double>::denorm_min();
/// Of streams: a compiler may take a residual's size to a whole number before it is cut off at 255, and throw that
/// away.
constexpr int kWatchedOfStreams = FE_DIVBYZERO | FE_OVERFLOW;
constexpr std::int64_t kMostJudgedOften = 60000;  ///< samples; larger regions are asked at fewer tolerances

std::string text(GridRect r) {
  return "(" + std::to_string(r.first.col) + ", " + std::to_string(r.first.row) + ") to (" +
         std::to_string(r.last.col) + ", " + std::to_string(r.last.row) + ")";
}

/// The terrain with its rows and columns in the order of the file.
Terrain turned(const Terrain& terrain, const RasterOptions& file) {
  const bool mirrored = file.geotransform[1]<0, south_up = file.geotransform[5]> 0;
  Terrain result = terrain;
  for (int row = 0; row < terrain.rows; ++row) {
    for (int col = 0; col < terrain.cols; ++col) {
      const std::size_t from =
          terrain.index(mirrored ? terrain.cols - 1 - col : col, south_up ? terrain.rows - 1 - row : row);
      result.at(col, row) = terrain.values[from];
      result.valid[result.index(col, row)] = terrain.valid[from];
    }
  }
  return result;
}

std::vector<std::string> kernels_of_this_cpu() {
  std::vector<std::string> names;
  for (const InstructionSet set : instruction_sets_here()) names.emplace_back(to_string(set));
  return names;
}

/// Does nothing where ingest knows no threads.
template <class Options>
void set_threads(Options& options, int threads) {
  if constexpr (requires { options.threads = threads; }) options.threads = threads;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) { return bits(x) == bits(y); });
}

std::pair<int, int> middle_part(int first, int last) {
  const int size = last - first + 1;
  // Around the first border of tiles, of pages or of blocks, with sides that lie on none.
  for (const int border : {1024, 128, 64}) {
    if (first + 37 <= border && border <= last - 37) return {border - 37, border + 37};
  }
  return {first + size / 5, last - size / 4};
}

}  // namespace

bool has_point(const Mesh& mesh, GridPoint p) {
  return std::find(mesh.points.begin(), mesh.points.end(), p) != mesh.points.end();
}

OracleOptions judging_in_degrees(const RasterOptions& file, int rows) {
  constexpr long double radius = 6378137, flattening = 1 / 298.257223563L;
  constexpr long double squared = flattening * (2 - flattening), degree = 3.14159265358979323846L / 180;
  OracleOptions judging{.cell_width_m = kInfinity, .cell_height_m = kInfinity};
  for (int row = 0; row < rows; ++row) {
    const long double y = static_cast<long double>(file.geotransform[3]) + (row + 0.5L) * file.geotransform[5];
    const long double latitude = std::clamp(y, -90.0L, 90.0L) * degree;
    const long double w = 1 - squared * std::sin(latitude) * std::sin(latitude);
    const long double width = std::max(0.0L, radius / std::sqrt(w) * std::cos(latitude) * degree);
    const long double height = radius * (1 - squared) / (w * std::sqrt(w)) * degree;
    judging.cell_width_m = std::min(judging.cell_width_m, static_cast<double>(width * std::abs(file.geotransform[1])));
    judging.cell_height_m =
        std::min(judging.cell_height_m, static_cast<double>(height * std::abs(file.geotransform[5])));
  }
  return judging;
}

Terrain hills(int cols, int rows, double amplitude) {
  return fit(sine_hills(cols, rows, amplitude, 151), SampleType::int16);
}

int HardDatabase::watched_of_ingest() const {
  // The order of a NaN and a number is invalid, and that is how one among samples is found.
  const bool has_nan = hard_.voids_are_nan || (hard_.file.nodata && std::isnan(*hard_.file.nodata));
  return FE_DIVBYZERO | FE_OVERFLOW | (has_nan ? 0 : FE_INVALID);
}

HardDatabase::HardDatabase(HardCase hard) : hard_(std::move(hard)), truth_(hard_.terrain) {
  hard_.judging.void_weight = hard_.void_weight;
  double low = kInfinity, high = -kInfinity;
  for (std::size_t i = 0; i < truth_.values.size(); ++i) {
    double& value = truth_.values[i];
    if (hard_.file.scale != 1 || hard_.file.offset != 0) value = value * hard_.file.scale + hard_.file.offset;
    if (truth_.valid[i] == 0) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  range_m_ = (high - low) * hard_.metres_per_unit;
  Terrain written = turned(hard_.terrain, hard_.file);
  for (std::size_t i = 0; hard_.voids_are_nan && i < written.values.size(); ++i) {
    if (written.valid[i] == 0) written.values[i] = std::nan(""), written.valid[i] = 1;
  }
  write_raster(written, folder_ / "hard.tif", hard_.file);
  IngestOptions options;
  options.void_weight = hard_.void_weight;
  (void)without_float_exceptions([&] { return ingest(folder_ / "hard.tif", folder_ / "hard.talus", options); },
                                 watched_of_ingest());
  now_ = Database::open(folder_ / "hard.talus").snapshot();
}

void HardDatabase::hold_to_the_promise() const {
  ASSERT_EQ(now().description().extent, extent());
  check_samples();
  const double reached = check_region(extent(), extent().samples() <= kMostJudgedOften);
  check_verify(reached);
  const auto [west, east] = middle_part(0, truth_.cols - 1);
  const auto [north, south] = middle_part(0, truth_.rows - 1);
  if (west <= east && north <= south) check_region({{west, north}, {east, south}}, true);
  for (const GridRect& region : hard_.regions) check_region(region, true);
  check_neighbours(reached);
  check_streams(reached);
  check_kernels_and_threads(reached);
}

void HardDatabase::check_samples() const {
  const SampleWindow window = now().samples(extent());
  ASSERT_EQ(window.values.size(), truth_.values.size());
  std::uint64_t voids = 0;
  for (std::size_t i = 0; i < truth_.values.size(); ++i) {
    voids += truth_.valid[i] == 0;
    const bool same = window.valid[i] == truth_.valid[i] &&
                      (truth_.valid[i] == 0 || bits(window.values[i]) == bits(truth_.values[i]));
    ASSERT_TRUE(same) << "sample " << i << " is " << window.values[i] << " valid " << int{window.valid[i]}
                      << ", the source has " << truth_.values[i] << " valid " << int{truth_.valid[i]};
  }
  EXPECT_EQ(now().description().void_samples, voids);
}

void HardDatabase::check_verify(double tolerance) const {
  const Raster raster(folder_ / "hard.tif");
  const VerifyReport report = verify(
      now(), [&](GridRect part) { return raster.read(part); }, Metres{tolerance});
  EXPECT_EQ(report.finding_count, 0u) << (report.findings.empty() ? "" : report.findings.front());
  EXPECT_EQ(report.uncovered_samples, 0u);
  ASSERT_TRUE(report.true_error.has_value());
  EXPECT_LE(report.true_error->value, tolerance + 1.01e-9);
}

double HardDatabase::judge(const Mesh& mesh, double tolerance) const {
  const OracleReport report = check_mesh(mesh, truth_, hard_.metres_per_unit, tolerance, hard_.judging);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_FALSE(std::isnan(report.largest_error));
  return report.largest_error;
}

Mesh HardDatabase::judged(GridRect region, double tolerance, double& true_error) const {
  SCOPED_TRACE(::testing::Message() << std::hexfloat << "tolerance " << tolerance << " m, region " << text(region));
  const Answer answer =
      without_float_exceptions([&] { return now().ask({.region = region, .tolerance = Metres{tolerance}}); });
  Mesh mesh = without_float_exceptions([&] { return triangulate(answer.quadtree); });
  EXPECT_EQ(mesh.region, region);
  EXPECT_EQ(answer.quadtree.tolerance.value, tolerance);
  true_error = judge(mesh, tolerance);
  // The bound may say a nanometre more than was asked where heights are no binary fractions, and nothing more.
  const bool whole_metres =
      hard_.file.type < SampleType::float32 && hard_.metres_per_unit == 1 && hard_.file.scale == 1;
  const double nanometre = whole_metres ? 0 : 1.01e-9;
  EXPECT_LE(true_error, answer.quadtree.bound.value + nanometre) << "the bound is no bound";
  EXPECT_LE(answer.quadtree.bound.value, tolerance + nanometre);
  return mesh;
}

Mesh HardDatabase::judged(GridRect region, double tolerance) const {
  double unused = 0;
  return judged(region, tolerance, unused);
}

double HardDatabase::check_region(GridRect region, bool all) const {
  const double medium = range_m_ > 0 ? range_m_ / 16 : 1;
  double reached = 0, unused = 0;
  std::vector<std::pair<double, Mesh>> answers;
  const auto ask = [&](double tolerance) { answers.emplace_back(tolerance, judged(region, tolerance, unused)); };
  answers.emplace_back(medium, judged(region, medium, reached));
  ask(0);
  ask(reached);
  if (reached > 0) ask(std::nextafter(reached, 0.0));
  ask(kInfinity);
  if (all) {
    ask(kSmallest);
    ask(std::nextafter(reached, kInfinity));
    ask(2 * range_m_ + 1);
    for (const double tolerance : hard_.tolerances) ask(tolerance);
  }
  if (truth_.has_voids()) return reached;  // beside voids a coarse outline may stand on vertices of its own

  std::stable_sort(answers.begin(), answers.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  VertexMask finer(region);
  for (const GridPoint p : answers.front().second.points) finer.insert(p);
  for (const auto& [tolerance, mesh] : answers) {
    VertexMask here(region);
    std::size_t strange = 0;
    for (const GridPoint p : mesh.points) {
      here.insert(p);
      strange += !finer.contains(p);
    }
    EXPECT_EQ(strange, 0u) << "vertices at " << tolerance << " m that a tighter tolerance has not; " << text(region);
    finer = std::move(here);
  }
  return reached;
}

void HardDatabase::check_neighbours(double tolerance) const {
  GridRect both = extent();
  const bool beside = both.cols() >= 33;
  if (!beside && both.rows() < 33) return;
  std::int32_t& first = beside ? both.first.col : both.first.row;
  std::int32_t& last = beside ? both.last.col : both.last.row;
  std::vector<std::int32_t> cuts{first + (last - first) / 2};
  for (const std::int32_t border : {64, 1024}) {
    if (first + 16 <= border && border <= last - 17) cuts.insert(cuts.end(), {border, border + 1});
  }
  const GridRect whole = both;
  for (const std::int32_t cut : cuts) {
    both = whole;
    first = std::max(first, cut - 80), last = std::min(last, cut + 75);
    GridRect one = both, other = both;
    (beside ? one.last.col : one.last.row) = cut;
    (beside ? other.first.col : other.first.row) = cut;
    SCOPED_TRACE("cut at " + std::to_string(cut) + " of " + text(both));
    const auto ask = [&](GridRect part) {
      return triangulate(now().ask({.region = part, .tolerance = Metres{tolerance}}).quadtree);
    };
    (void)judge(join(ask(one), ask(other), both), tolerance);
  }
}

Mesh HardDatabase::streamed(const RestrictedQuadtree& answer) const {
  const Stream stream{now().description(), answer};
  const auto back = without_float_exceptions(
      [&] { return decode_stream(encode(stream, {.stripes = 2}), {}, nullptr, 2).content; }, kWatchedOfStreams);
  const auto& read = std::get<RestrictedQuadtree>(back);
  EXPECT_EQ(difference(read, answer), "");
  Mesh mesh = triangulate(read);
  OracleOptions judging = hard_.judging;
  judging.heights_are_source = answer.origin.quantum.value == 0;
  const OracleReport report =
      check_mesh(mesh, truth_, hard_.metres_per_unit, std::max(answer.tolerance.value, answer.bound.value), judging);
  EXPECT_TRUE(report.sound()) << report.summary();
  EXPECT_LE(report.largest_error, answer.bound.value + 1.01e-9) << "the bound is no bound";
  EXPECT_LE(answer.bound.value, answer.tolerance.value + 1e-8);
  return mesh;
}

void HardDatabase::check_streams(double tolerance) const {
  RestrictedQuadtree client = now().ask({.region = extent(), .tolerance = Metres{kInfinity}}).quadtree;
  double from = kInfinity;
  for (const double to : {tolerance, 0.0}) {
    SCOPED_TRACE(::testing::Message() << std::hexfloat << "streams at tolerance " << to << " m");
    if (!(to < from)) continue;
    const RestrictedQuadtree answer = now().ask({.region = extent(), .tolerance = Metres{to}}).quadtree;
    const Increment more = increment_of(now().ask({.region = extent(), .tolerance = Metres{to}, .from = Metres{from}}));
    const auto back = [&](const Stream& stream, const RestrictedQuadtree* base) {
      return without_float_exceptions(
          [&] { return decode_stream(encode(stream, {.stripes = 2}, base), {}, base, 2).content; }, kWatchedOfStreams);
    };
    EXPECT_EQ(difference(std::get<RestrictedQuadtree>(back({now().description(), answer}, nullptr)), answer), "");
    const Increment read = std::get<Increment>(back({now().description(), more}, &client));
    EXPECT_EQ(difference(merge(client, read), answer), "");
    client = answer, from = to;
  }
}

void HardDatabase::check_kernels_and_threads(double tolerance) const {
  const auto answers = [&](const std::filesystem::path& file) {
    const Snapshot other = Database::open(file).snapshot();
    std::vector<Mesh> meshes;
    for (const double t : {0.0, tolerance, kInfinity}) meshes.push_back(other.mesh(Metres{t}));
    return meshes;
  };
  const std::vector<Mesh> expected = answers(folder_ / "hard.talus");
  const auto expect_same = [&](int threads) {
    IngestOptions options;
    options.void_weight = hard_.void_weight;
    options.overwrite = true;
    set_threads(options, threads);
    (void)without_float_exceptions([&] { return ingest(folder_ / "hard.tif", folder_ / "other.talus", options); },
                                   watched_of_ingest());
    const std::vector<Mesh> got = answers(folder_ / "other.talus");
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_TRUE(got[i].points == expected[i].points && got[i].triangles == expected[i].triangles &&
                  same_bits(got[i].heights, expected[i].heights))
          << "another answer at tolerance "
          << (i == 0   ? 0.0
              : i == 1 ? tolerance
                       : kInfinity);
    }
  };
  for (const std::string& kernel : kernels_of_this_cpu()) {
    SCOPED_TRACE(std::string("kernel ") + kernel);
    const ForcedKernel forced(kernel);
    expect_same(2);
  }
  SCOPED_TRACE("one thread");
  expect_same(1);
}

}  // namespace talus::support
