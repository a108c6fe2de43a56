#pragma once
// Databases, and the questions they answer.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "talus/cost.hpp"
#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/increment.hpp"
#include "talus/quadtree.hpp"
#include "talus/question.hpp"
#include "talus/units.hpp"

namespace talus {

struct Answer {
  RestrictedQuadtree quadtree;
  std::uint64_t border_vertices = 0;    ///< vertices that only the border needs
  std::uint64_t matching_vertices = 0;  ///< vertices that only Question::neighbours need
  /// Vertices on shared sides that a neighbour lacks. There the two meet with cracks until you ask for the neighbour
  /// again, with this answer as its neighbour.
  std::vector<GridPoint> unmatched = {};
  std::uint64_t points = 0;          ///< samples that Question::points, places and lines name
  std::uint64_t point_vertices = 0;  ///< vertices that only these samples need
  std::uint64_t void_points = 0;     ///< void samples among them, which cannot be vertices
  /// Question::from. The quadtree then has only the vertices that the answer at `from` lacks, and makes no mesh.
  std::optional<Metres> from = {};
  QueryCost cost;    ///< cost without `search`
  QueryCost search;  ///< cost of finding the tolerance for a budget (quadtree.tolerance); 0 without a budget
};

/// An answer to a question with Question::from, as an increment for merge() and streams.
/// fails  invalid_argument: the question had no `from`
[[nodiscard]] Increment increment_of(Answer answer);

/// A rectangle in CRS coordinates, as samples and grid coordinates.
struct PlacedRectangle {
  GridRect samples;     ///< grown outward to samples, cut at the extent
  Frame frame;          ///< the rectangle in grid coordinates, cut at the outermost samples
  bool is_cut = false;  ///< the rectangle reaches beyond the raster's outermost cells
};

struct ProfileVertex {
  Metres distance;      ///< from the start of the line along it, on the ground
  double x = 0, y = 0;  ///< in the CRS
  double height = 0;    ///< in the vertical unit
};

/// The heights of a surface along a line. Between two vertices of a part the height is linear in x and y.
struct Profile {
  std::vector<std::vector<ProfileVertex>> parts;  ///< in the line's order, with gaps where there is no data
  Metres length;                                  ///< length of the whole line on the ground, gaps included
  Metres tolerance;                               ///< as asked
  Metres bound;  ///< no covered sample on the line is farther from the profile, see RestrictedQuadtree::bound
  QueryCost cost;
};

struct BandSummary {
  std::int32_t spacing = 1;  ///< spacing of the band's finest vertices, in cells
  std::uint64_t pages = 0, bytes = 0;
};

struct StorageSummary {
  std::uint64_t file_bytes = 0, pages = 0, page_bytes = 0;
  std::uint64_t slices = 0, slice_bytes = 0;  ///< second copies of the vertices with the largest errors, one a tile
  std::vector<BandSummary> bands;             ///< finest first
  int format_version = 0;
};

/// One consistent view of a database: later updates do not change it. It may outlive the Database. Keep it short: while it lives, the system cannot
/// free the space of a file that has been replaced.
///
/// Threads: any number may use one snapshot at once, and it may move between them.
///
/// In a geographic CRS, longitudes a full turn apart are the same place. A line goes the shorter way around the globe
/// from each point to the next.
///
/// Every question can fail with out_of_memory, with corrupt (a damaged page) and with io (the file was cut short, or
/// its disk fails).
class Snapshot {
 public:
  ~Snapshot();
  Snapshot(Snapshot&&) noexcept;
  Snapshot& operator=(Snapshot&&) noexcept;

  [[nodiscard]] const Description& description() const;
  [[nodiscard]] StorageSummary storage() const;
  /// The inputs, the state of the database, and how many vertices tolerances need.
  [[nodiscard]] Provenance provenance() const;

  /// The samples of a rectangle: grown outward to grid lines (within 10⁻⁶ cell of a line counts as on it), then cut at
  /// the raster. In a geographic CRS xmin > xmax is a box across the antimeridian, at most half a turn wide.
  /// fails  invalid_argument: xmin, xmax or ymin, ymax swapped or equal; NaN; a rectangle outside the raster; one that
  ///        meets both ends of a raster around the globe
  [[nodiscard]] PlacedRectangle region(const Rectangle& rectangle) const;

  /// Answers a question. For a region and a tolerance: every valid sample under the surface is within the tolerance of
  /// it, and no triangle leaves the region. Answers at one tolerance meet without cracks if their regions share a whole
  /// side and are at least 16 cells deep there.
  ///
  /// Voids: half of a unit cell, cut along the diagonal between corners with even column + row, is a valid finest
  /// triangle if its three corners are valid. Every corner of such a triangle (a *covered sample*) lies under the
  /// surface. A larger triangle with data and voids is kept if its longest side on the ground times
  /// Description::void_weight is within the tolerance. It may have void vertices, with heights of samples nearby.
  ///
  /// A tolerance below Description::lossy or finest_tolerance returns the finest answer; its bound says so. With
  /// a field, each sample is within its own tolerance, and neighbouring answers need not meet. The quadtree of
  /// Border::cover and clip also has vertices outside the region, which its triangles need. Rounded heights meet if
  /// kind, tolerance and quantum are equal. If a database kept only the vertices of one tolerance, every finer answer
  /// has the same vertices, and increments between them are empty.
  ///
  /// returns  a quadtree; its mesh is empty where there are only voids, or in a region one sample wide
  /// fails    invalid_argument: fields that cannot be combined; a region or point outside; a
  ///          negative tolerance or level; `from` not above the tolerance; a neighbour of another state or without a
  ///          shared side; a budget below what the border needs; rounded heights at tolerance 0 or infinity, with a
  ///          quantum too large for the tolerance or beyond 10¹⁵ multiples of it. unsupported: fitted heights, or
  ///          bounded ones without a quantum, if the database did not keep all samples. cancelled, too_large
  /// cost     reads the pages with errors above the tolerance, their ancestors, and pages along odd borders; an
  ///          increment skips the border. A field, another border, a level, points or neighbours read pages twice.
  ///          Bounded heights without a quantum: 9 bytes a sample of the region and a few times the time; fitted: 26
  ///          bytes and 3 to 14 times the time; dense: as exact at tolerance 0
  /// source   [P98 §4, §10]; the border: docs/architecture.md
  [[nodiscard]] Answer ask(const Question& question) const;

  /// Answers several questions so that all answers meet without cracks, wherever two regions share a side or a part of
  /// one, at any tolerances and however thin they are.
  ///
  /// returns  one answer a question, in their order; `unmatched` can only name vertices of their own neighbours. Limits
  ///          hold for each question; a stop token of one stops all
  /// fails    as ask
  /// cost     ask() for each question, and the vertices of all answers in memory
  /// source   [P98 §9]
  [[nodiscard]] std::vector<Answer> ask_together(std::span<const Question> questions) const;

  /// The mesh of the whole raster or of a rectangle: ask() and triangulate().
  [[nodiscard]] Mesh mesh(Metres tolerance) const;
  [[nodiscard]] Mesh mesh(const Rectangle& rectangle, Metres tolerance) const;

  /// The height at a point, in the vertical unit. Without `surface`: bilinear between the four samples around it. On a
  /// line between two samples (within 10⁻⁶ cell) it needs only these two; on a sample it has that height, bit for bit.
  ///
  /// surface  a tolerance: the height of the whole raster's answer at it, as a mesh shows it
  /// returns  empty outside the extent, where a sample that it needs is void, where the surface has no triangle, or if
  ///          a coordinate is not finite
  /// fails    unsupported: no tolerance, and the database did not keep all samples; invalid_argument: the tolerance
  /// cost     a few pages; the first surface of a snapshot also the border's vertices, linear in the extent's sides
  [[nodiscard]] std::optional<double> height(double x, double y, std::optional<Metres> surface = {}) const;
  /// The heights at many points in any order. Each page is decoded once.
  /// out    one element a point
  /// fails  as height; invalid_argument: `out` has another size
  /// cost   with decoded pages 0.5 µs a point, 1 to 2 µs on a surface
  QueryCost heights(std::span<const Position> points, std::span<std::optional<double>> out,
                    std::optional<Metres> surface = {}) const;

  /// The height along a line of two or more points, straight between them in CRS coordinates. It cuts every triangle
  /// of a surface at half the tolerance, then leaves out vertices while covered samples on the line stay within the
  /// tolerance. The line's points and the ends of parts stay. A new part begins after each gap without triangles.
  /// fails  invalid_argument: fewer than two points, all points at one place, a coordinate that is not finite, the
  ///        tolerance
  /// cost   the pages along the line, linear in the triangles under it; the first call also as height()
  [[nodiscard]] Profile profile(std::span<const Position> line, Metres tolerance) const;

  /// Stored samples of a region within the extent, equal to the source's bit for bit.
  /// fails  invalid_argument; unsupported: the database did not keep all samples
  [[nodiscard]] SampleWindow samples(GridRect region) const;

 private:
  friend class Database;
  friend const class StoredPages& pages_of(const Snapshot& snapshot);
  struct View;
  explicit Snapshot(std::unique_ptr<View> view);
  std::unique_ptr<View> view_;
};

/// The saturated errors of an answer's vertices, by rank, in metres; infinity for root corners. For Progression.
///
/// fails  invalid_argument: vertices outside the extent; corrupt: a page is damaged or missing
/// cost   reads the pages of these vertices
[[nodiscard]] std::vector<double> errors_of(const Snapshot& now, const RestrictedQuadtree& answer);

/// Whether a point lies on or between samples. Outside, no question has an answer.
[[nodiscard]] bool is_inside(const Snapshot& now, Position point);

struct OpenOptions {
  /// Bytes of decoded pages to keep for later questions, 14 to 20 bytes a sample. 0: keep none.
  std::uint64_t cache_bytes = std::uint64_t{64} << 20;
  /// Threads of a question that does not set Question::threads; 0: one a core. Answers do not depend on it.
  int threads = 0;
};

/// An open database. Copies share one file and one cache. Every open() has a cache of its own, so open each file once.
///
/// A database file never changes in place: update() and compact() write a new file and rename it. An open Database and
/// its snapshots keep the old file, so all their answers have the old state. is_current() says whether the name still
/// leads to the open file; reopen() opens the new one. The system frees the old file with its last Database and
/// Snapshot. If another program writes into the open file or cuts it short, questions fail with io, is_current() is
/// false, and reopen() opens what the file is now.
///
/// Threads: any number may call everything at once, except assign to a Database that others use.
class Database {
 public:
  /// fails  not_found; corrupt: not a database, or a damaged header; unsupported: another version; out_of_memory
  [[nodiscard]] static Database open(const std::filesystem::path& file, const OpenOptions& options = {});
  [[nodiscard]] Snapshot snapshot() const;

  /// Whether the name still leads to the open file. False if there is no file of that name.
  /// cost  one look at the file system
  [[nodiscard]] bool is_current() const;
  /// Opens the file that has the name now, with the same options. If it is still the same file: a copy.
  /// fails  as open
  [[nodiscard]] Database reopen() const;

 private:
  struct Opened;
  explicit Database(std::shared_ptr<Opened> opened);
  std::shared_ptr<Opened> opened_;
};

/// Cuts a mesh at a frame. Heights on the cuts lie on mesh edges, so the bound holds. Meshes from one answer that are
/// cut at frames with a common side meet there without cracks.
///
/// mesh  the mesh of an answer with Border::cover whose region contains the frame
/// cost  linear
[[nodiscard]] Mesh clip_mesh(const Mesh& mesh, Frame frame);

// ---- verify --------------------------------------------------------------------------------------

/// A damaged rectangle of a database.
struct DamagedPart {
  GridRect samples;            ///< answers that need these samples may be wrong or refused
  Rectangle rectangle;         ///< the same in the CRS, from outermost to outermost sample
  std::string finding;         ///< the first finding in it
  std::uint64_t findings = 1;  ///< number of findings in it
};

/// What verify() found. Each finding is a sentence with a page or a sample. No findings: the database is sound.
struct VerifyReport {
  std::uint64_t pages = 0, records = 0, samples = 0;  ///< checked
  std::vector<std::string> findings;                  ///< the first 20
  std::uint64_t finding_count = 0;
  /// The findings that are not damage: the database differs from the truth, or the surface exceeds the bound.
  std::uint64_t differences = 0;
  [[nodiscard]] bool is_damaged() const { return finding_count > differences; }
  std::vector<DamagedPart> damaged;  ///< the first 1000, in the order of finding
  /// All damage lies in `damaged`: answers that need nothing from there are right. False if something is damaged that
  /// all answers need, or if the file's own structure is.
  bool is_rest_usable = true;
  std::uint64_t answers = 0;                  ///< answers that were checked
  std::optional<Metres> true_error;           ///< true error of the answer at VerifyOptions::tolerance, vertical
  std::optional<Metres> perpendicular_error;  ///< the same at right angles, if that is the database's metric
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t covered_samples = 0, uncovered_samples = 0;  ///< see Snapshot::ask; none should be uncovered
  std::uint64_t stray_samples = 0;  ///< valid samples outside all valid finest triangles, and under no triangle
};

/// Reads a rectangle of the true heights.
using SampleReader = std::function<SampleWindow(GridRect)>;

struct VerifyOptions {
  /// The source before ingest rounded anything. Every stored sample is compared with it: bit for bit, or within
  /// Description::lossy. With a finest tolerance: the stored samples, and the answer at that tolerance.
  SampleReader truth = {};
  /// Needs `truth`: measures the true error of the whole answer at this tolerance, over every sample.
  std::optional<Metres> tolerance = {};
  /// Called now and then with the share of the work that is done (0 to 1) and its stage. May throw to stop the work.
  std::function<void(double fraction, const char* stage)> progress = {};
};

/// Checks a whole database and lists all findings:
/// - the file: its structure, and every byte against the seal
/// - pages: checksums, child entries, heights and voids that two pages share, errors never below those of vertices that
///   depend on them
/// - everything that follows from the samples, computed again: errors, covers, fills, tile records, coarse levels,
///   minimum and maximum, counts. If the database did not keep all samples: its coarse levels only
/// - answers at 0 and at 1, 2, 5 … m up to the largest error, whole or in squares of 2048 samples
///
/// It finds everything that a question would refuse. It does not find another mapping, CRS or name in the manifest, nor
/// changed samples if everything that follows from them changed too; a `truth` finds these samples.
///
/// fails  not_found, io; whatever the truth or `progress` throws. Damage is a finding, not a failure
/// cost   the time of an ingest without reading its inputs, and of some answers for the whole raster. Memory: about
///        120 MB, 40 bytes for each 64² samples, and an answer of 2048² samples (some 250 MB); with a tolerance, the
///        mesh of the whole answer
[[nodiscard]] VerifyReport verify(const Snapshot& snapshot, const VerifyOptions& options = {});
[[nodiscard]] VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth);
[[nodiscard]] VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth, Metres tolerance);

// ---- export --------------------------------------------------------------------------------------

/// Writes a mesh. The name of `file` ends in .ply (binary little endian, double x y z), .obj or .glb (glTF 2.0, y up,
/// metres). The file is written under another name and then renamed, so it appears whole or not at all. For rasters and
/// pictures see talus/raster_output.hpp.
///
/// returns  how far the file's surface may lie from the mesh (.glb stores floats): add it to the answer's bound
/// fails    invalid_argument: another ending, or a mesh whose parts do not match; unsupported; io, full
Metres write_mesh(const Mesh& mesh, const Description& description, const std::filesystem::path& file);

}  // namespace talus
