#pragma once
// Databases and the questions they answer.

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
  std::uint64_t border_vertices = 0;    ///< of the quadtree, that only the border needs
  std::uint64_t matching_vertices = 0;  ///< that came for neighbours alone, see Question::neighbours
  /// Vertices on shared sides that a neighbour lacks: where there are any, the two meet with cracks until the neighbour
  /// is asked again with this answer as its neighbour.
  std::vector<GridPoint> unmatched = {};
  std::uint64_t point_vertices = 0;  ///< that are there for Question::points alone, with all these depend on
  std::uint64_t void_points = 0;     ///< points asked for that are no vertices, for they have no data
  QueryCost cost;
};

struct ProfileVertex {
  double distance_m = 0;  ///< on the ground, from the first point of the line along it
  double x = 0, y = 0;    ///< in the CRS
  double height = 0;      ///< in the vertical unit
};

/// A surface along a line: between two vertices of a part the height is linear in x and y.
struct Profile {
  std::vector<std::vector<ProfileVertex>> parts;  ///< in the line's order; between two of them is no data
  double length_m = 0;                            ///< of the line on the ground, with what lies between parts
  Metres tolerance;                               ///< as asked
  Metres bound;  ///< no covered sample on the line is farther from the profile; see RestrictedQuadtree::bound
  QueryCost cost;
};

struct BandSummary {
  std::int32_t spacing = 1;  ///< of the finest vertices of this band's pages, in cells
  std::uint64_t pages = 0, bytes = 0;
};

struct StorageSummary {
  std::uint64_t file_bytes = 0, pages = 0, page_bytes = 0;
  std::vector<BandSummary> bands;  ///< finest first
  int format_version = 0;
};

/// One consistent view of a database. It may move between threads and be asked from several at once.
/// Keep it short: as long as one lives, a writer cannot reuse the pages it sees.
class Snapshot {
 public:
  ~Snapshot();
  Snapshot(Snapshot&&) noexcept;
  Snapshot& operator=(Snapshot&&) noexcept;

  [[nodiscard]] const Description& description() const;
  [[nodiscard]] StorageSummary storage() const;
  /// What it was made from, and how many vertices tolerances select.
  [[nodiscard]] Provenance provenance() const;

  /// Of all questions: in a geographic CRS longitudes a full turn apart are one place, whichever is written. Each next
  /// point of a line is taken on the turn nearest to the one before.

  /// The samples a rectangle covers: outward to grid lines (a coordinate within 10⁻⁶ cell of a line is
  /// on it), then clipped to the raster. In a geographic CRS xmin > xmax is the box across the antimeridian, if it is
  /// at most half a turn wide.
  /// fails  invalid_argument: swapped, empty or NaN corners, or nothing in common with the raster; a box at both ends
  ///        of a raster that goes around the globe
  [[nodiscard]] GridRect region(const Rectangle& rectangle) const;

  /// Whether a rectangle reaches farther than the raster's outermost cells: region() leaves that out.
  /// fails  as region
  [[nodiscard]] bool is_cut(const Rectangle& rectangle) const;

  /// The rectangle itself, where grid lines are whole numbers (within 10⁻⁶ of one it is on it), cut at the raster's
  /// outermost samples: what an answer is clipped to.
  /// fails  as region
  [[nodiscard]] Frame frame(const Rectangle& rectangle) const;

  /// The restricted quadtree of a region at a tolerance, its border constrained: every valid sample under
  /// the surface lies within `tolerance` of it, every covered sample of the region lies under it, no
  /// triangle leaves the region, and answers at one tolerance for regions that share a whole side, each at
  /// least 16 cells deep across it, meet without a crack.
  ///
  /// Without voids every sample is covered. Beside voids a sample is covered iff it is a corner of a valid
  /// finest triangle: half a unit cell, cut along the diagonal that joins corners of even column + row, its
  /// three corners data. A coarse triangle that mixes data and void is kept if its longest ground side times
  /// Description::void_weight is within the tolerance; it may stand on void vertices, whose heights are those of
  /// samples near them.
  ///
  /// region     within the extent
  /// tolerance  metres, >= 0, infinity allowed; below what stored heights can keep (Description::lossy_metres and
  ///            finest_tolerance) the answer is the finest there is, and its bound says so
  /// returns    an empty quadtree's mesh has no triangles: only voids, or a region one sample wide
  /// fails      invalid_argument; corrupt for a damaged page
  /// cost       pages that hold something above the tolerance, their ancestors, and those on odd borders
  /// source     [P98 §4, §10], design of the border: docs/architecture.md
  [[nodiscard]] Answer range(GridRect region, Metres tolerance) const;

  /// The same with another border, a tolerance that varies, levels or points that are asked for; see Question. The
  /// quadtree of `cover` and `clip` holds what its triangles need beyond the region; triangulate() gives exactly the
  /// triangles of the whole raster's answer that meet it.
  ///
  /// A field's answer holds every covered sample within its own tolerance: a vertex is left out only if its error is
  /// within the least tolerance of its diamond. Two such answers need not meet.
  ///
  /// fails  as range; invalid_argument: a point outside the region, a level below 0, a field or neighbours with another
  ///        border than constrain, a neighbour of another database or state, or one that shares no side
  /// cost   as range, and pages looked at twice unless nothing but a region and a tolerance is asked
  [[nodiscard]] Answer ask(const Question& question) const;

  /// The same as range with heights that are multiples of a quantum, which a stream holds in fewer bits: every sample
  /// is held against the surface with these heights, which is split only where one lies beyond the tolerance. Fewer
  /// vertices than range mostly, for no vertex is there for its error's sake alone. Answers at one tolerance and
  /// quantum meet as those of range do; increments go on from none of them.
  ///
  /// quantum  metres; 0: about the tolerance
  /// fails    as range; invalid_argument: a tolerance of 0 or infinity, a quantum that lies farther from heights than
  ///          the tolerance, or of which heights are more than 10¹⁵ multiples; unsupported: a database that keeps the
  ///          vertices of a tolerance only
  /// cost     memory: 9 bytes a sample of the region. Time: a few times that of range
  [[nodiscard]] Answer bounded(GridRect region, Metres tolerance, Metres quantum = Metres{0}) const;

  /// The fewest vertices: heights move within the tolerance of the source's, to where most triangles can stay, and
  /// every sample is held against them. On rough ground, at five height steps and more, 16 to 26 % fewer than range;
  /// nothing goes on from them.
  /// Answers at one tolerance and quantum meet as those of range do.
  ///
  /// quantum  metres that heights are multiples of; 0: half the tolerance. A smaller one mostly needs fewer vertices,
  ///          and more bytes
  /// fails    as bounded
  /// cost     memory: 26 bytes a sample of the region. Time: three to fourteen times that of range
  /// source   relaxation of linear inequalities: Agmon 1954, Motzkin and Schoenberg 1954
  [[nodiscard]] Answer fitted(GridRect region, Metres tolerance, Metres quantum = Metres{0}) const;

  /// The whole tolerance spent on rounding: of the samples only those are left out that lie exactly between others.
  /// More vertices than any other answer, and where a mesh would need most samples anyway, that is up to some ten
  /// height steps on rough ground, the fewest bytes.
  ///
  /// fails  as range; invalid_argument: a tolerance of 0 or infinity
  /// cost   that of range at tolerance 0
  [[nodiscard]] Answer dense(GridRect region, Metres tolerance) const;

  /// range at the tolerance less what rounding to a quantum costs, rounded: more vertices, but nested, so that
  /// increments of the same quantum go on from it.
  /// fails  as range; invalid_argument: a quantum of 0, or as bounded
  [[nodiscard]] Answer quantised(GridRect region, Metres tolerance, Metres quantum) const;
  /// What such an answer lacks of a finer one.
  /// fails  as increment and quantised
  [[nodiscard]] Increment quantised_increment(GridRect region, Metres from, Metres to, Metres quantum) const;

  /// Several questions whose answers meet without a crack wherever two of the regions share a side or a part of one, at
  /// whatever tolerances and however thin they are: vertices there are shared, back and forth until none is missing.
  ///
  /// returns  answers in the order of the questions, none with anything unmatched but by neighbours of its own
  /// fails    as ask; invalid_argument: another border than constrain
  /// cost     that of ask for each question, and the vertices of all at once
  /// source   [P98 §9]
  [[nodiscard]] std::vector<Answer> ask_together(std::span<const Question> patches) const;

  /// The smallest tolerance on the ladder of stored errors (engine/error/error_ladder.hpp) whose answer
  /// with a constrained border fits a budget. Exact, and without trial: pages with the largest errors are counted
  /// first, until no other can matter.
  /// fails  invalid_argument: region as in range; a budget that the border alone exceeds, naming what it needs
  /// cost   pages with errors above the result, the border's pages
  [[nodiscard]] Metres tolerance_for(GridRect region, const Budget& budget) const;
  /// The same, and what it cost.
  [[nodiscard]] Metres tolerance_for(GridRect region, const Budget& budget, QueryCost& cost) const;

  /// What an answer at `from` lacks of the one at `to`, see Increment and merge. In a database that keeps the vertices
  /// of a tolerance only, answers at that tolerance and below have the same vertices: between two of them it is empty.
  ///
  /// fails  invalid_argument: as range; `to` not below `from`. corrupt for a damaged page
  /// cost   pages that hold something above `to`, and their ancestors; what the border needs is not read
  [[nodiscard]] Increment increment(GridRect region, Metres from, Metres to) const;

  /// The saturated errors of an answer's vertices, by rank, in metres; infinity for root corners. For Progression.
  ///
  /// fails  invalid_argument: vertices outside the extent; corrupt for a damaged page, or a vertex without one
  /// cost   the pages with these vertices
  [[nodiscard]] std::vector<double> errors(const RestrictedQuadtree& answer) const;

  /// Of this state of the database.
  [[nodiscard]] Identity identity() const;

  /// Range query and triangulation in one: the whole raster, or what a rectangle covers.
  [[nodiscard]] Mesh mesh(Metres tolerance) const;
  [[nodiscard]] Mesh mesh(const Rectangle& rectangle, Metres tolerance) const;

  /// The height at a point in the vertical unit, bilinear between the four samples around it. Samples are pixel
  /// centres. A point on a line of samples, or within 10⁻⁶ cell of one, needs only the two on either side along the
  /// line; one on a sample needs that sample, and gets its height bit for bit.
  /// returns  nothing where a sample that is needed is void or outside the extent, or a coordinate is no number
  /// fails    unsupported: a database that keeps the vertices of a tolerance only; corrupt
  [[nodiscard]] std::optional<double> height(double x, double y) const;
  /// The height of a surface: that of the whole extent's answer at a tolerance, as range() of the extent gives it. So
  /// this is what a mesh shows there, and within the tolerance of covered samples.
  /// tolerance  as of range(); any database has surfaces
  /// returns    nothing where no triangle is: outside the extent, beside data
  /// fails      invalid_argument: the tolerance; corrupt
  /// cost       a few pages, and for the first of a snapshot the border's vertices, in proportion to the extent's sides
  [[nodiscard]] std::optional<double> height(double x, double y, Metres tolerance) const;
  /// Many points at once, answers in their order: each page is decoded once, however the points are strewn.
  /// out    of the size of `points`
  /// fails  as above; invalid_argument: of another size
  /// cost   where the pages are decoded half a microsecond a point, one to two on a surface
  QueryCost heights(std::span<const Position> points, std::span<std::optional<double>> out) const;
  QueryCost heights(std::span<const Position> points, Metres tolerance, std::span<std::optional<double>> out) const;
  /// Whether a point lies among the samples, on the outermost ones included: beyond no question has an answer.
  [[nodiscard]] bool is_inside(Position point) const;

  /// The height along a line through two or more points, straight between them in CRS coordinates. Half of the
  /// tolerance goes to the surface whose every triangle under the line is cut, and what its bound leaves of the whole
  /// to leaving out vertices of that cut, so that the profile is within the tolerance of covered samples on the line.
  /// The line's points and the ends of parts stay. It ends and begins anew where no triangle is: beside data, outside
  /// the extent; where it touches a triangle in one point it has no part.
  /// fails  invalid_argument: fewer than two points, all at one place, a coordinate that is no finite number, the
  ///        tolerance; corrupt
  /// cost   the pages along the line, in proportion to the triangles under it; the first also as height()
  [[nodiscard]] Profile profile(std::span<const Position> line, Metres tolerance) const;

  /// Stored samples, bit for bit as the source had them. `region` within the extent.
  /// fails  invalid_argument; unsupported: a database that keeps the vertices of a tolerance only
  [[nodiscard]] SampleWindow samples(GridRect region) const;

 private:
  friend class Database;
  friend const class StoredPages& pages_of(const Snapshot& snapshot);
  struct View;
  explicit Snapshot(std::unique_ptr<View> view);
  std::unique_ptr<View> view_;
};

struct OpenOptions {
  /// Of decoded pages that are kept for the next question, at 14 to 20 bytes a sample. 0: none is.
  std::uint64_t cache_bytes = std::uint64_t{64} << 20;
  /// For one question about a million samples or more, if it asks for nothing but a region and a tolerance; 0: all the
  /// machine has. Answers do not depend on it.
  int threads = 1;
};

/// An open database file. Copies share one environment and one cache; a file is opened once per process.
class Database {
 public:
  /// fails  not_found; corrupt: not a database or a damaged header; unsupported: another version
  [[nodiscard]] static Database open(const std::filesystem::path& file, const OpenOptions& options = {});
  [[nodiscard]] Snapshot snapshot() const;

 private:
  struct Opened;
  explicit Database(std::shared_ptr<Opened> opened);
  std::shared_ptr<Opened> opened_;
};

/// The unique conforming triangulation of a quadtree, without recursion. Linear time. [P98 §3]
///
/// threads  for large quadtrees; 0: all the machine has. The mesh does not depend on it
/// fails    corrupt: vertices that are not closed under their parents, as damaged errors select
[[nodiscard]] Mesh triangulate(const RestrictedQuadtree& quadtree, int threads = 1);

/// A mesh cut at a frame; heights along the cuts are those of its edges, so its bound holds. Meshes of one answer that
/// are cut at frames that share a whole side meet there without a crack.
///
/// mesh  of an answer with Border::cover whose region the frame lies in
/// cost  linear
[[nodiscard]] Mesh clip_mesh(const Mesh& mesh, Frame frame);

// ---- verify --------------------------------------------------------------------------------------

/// A rectangle of a database in which something is wrong.
struct DamagedPart {
  GridRect samples;            ///< an answer that needs them may be refused, or wrong
  Rectangle rectangle;         ///< the same in the CRS, from the outermost samples to the outermost samples
  std::string finding;         ///< the first finding about it
  std::uint64_t findings = 1;  ///< how many there are
};

/// What a check found. Empty `findings` means sound; each finding is a sentence naming page or sample.
struct VerifyReport {
  std::uint64_t pages = 0, records = 0, samples = 0;  ///< checked
  std::vector<std::string> findings;                  ///< at most 20 are spelled out
  std::uint64_t finding_count = 0;
  /// So many of the findings do not say that the database is damaged: it is sound in itself and differs from the truth,
  /// or its surface lies beyond the bound.
  std::uint64_t differences = 0;
  [[nodiscard]] bool is_damaged() const { return finding_count > differences; }
  std::vector<DamagedPart> damaged;  ///< at most 1000, in the order in which they were found
  /// All damage lies in `damaged`: answers that need nothing from there are right. False where something is wrong that
  /// all answers depend on, or where the file cannot be followed.
  bool is_rest_usable = true;
  std::uint64_t answers = 0;         ///< asked and triangulated
  std::optional<Metres> true_error;  ///< of the answer, along the vertical, by brute force, if a tolerance was given
  std::optional<Metres> perpendicular_error;  ///< the same at right angles, of a database with that metric
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t covered_samples = 0, uncovered_samples = 0;  ///< see Snapshot::range; none may be uncovered
  std::uint64_t stray_samples = 0;  ///< valid, in no valid finest triangle, and under no triangle
};

/// Reads a rectangle of the truth to compare with.
using SampleReader = std::function<SampleWindow(GridRect)>;

struct VerifyOptions {
  /// The source as it was before ingest rounded anything: every stored sample is held against it, bit for bit, or
  /// within Description::lossy_metres. Of a database with a finest tolerance those it kept, and the whole answer at
  /// that tolerance.
  SampleReader truth = {};
  /// With a truth: the true error of the whole answer at this tolerance, its mesh held against every sample.
  std::optional<Metres> tolerance = {};
  /// Told now and then how much of the work is done, 0 to 1, and what is being done. May throw to end the work.
  std::function<void(double fraction, const char* stage)> progress = {};
};

/// Holds a database against itself, and goes on after the first finding:
/// - the file: its trees, and every byte against its seal
/// - pages: checksums; tables of pages below them; heights and voids that a page above repeats; errors never below
///   those of vertices that depend on them, across pages too
/// - what follows from the stored samples is computed again, tile by tile, and compared: errors, triangles with data,
///   fills, records; from the records the coarse levels, the manifest's extremes and the provenance's counts. A
///   database with a finest tolerance has not kept all samples: there only its coarse levels are computed again
/// - answers at 0 and at 1, 2, 5 … m up to the largest error are asked and triangulated, as a whole or in squares of
///   2048 samples
///
/// What a query refuses is found here. What is not found: another mapping, CRS or name in the manifest, and samples
/// that were changed with everything that follows from them; a truth finds these samples.
///
/// fails  not_found, io; what the truth and `progress` throw. Damage is no failure
/// cost   the time of an ingest without its reading, and of some answers to the whole raster. Memory: about 120 MB, 40
///        bytes for each 64² samples, and an answer of 2048² samples (some 250 MB); with a tolerance the mesh of the
///        whole answer
[[nodiscard]] VerifyReport verify(const Snapshot& snapshot, const VerifyOptions& options = {});
[[nodiscard]] VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth);
[[nodiscard]] VerifyReport verify(const Snapshot& snapshot, const SampleReader& truth, Metres tolerance);

// ---- export --------------------------------------------------------------------------------------

/// Writes a mesh. The ending of `file` says how: .ply (binary little endian, double x y z), .obj, .glb (glTF 2.0, y up,
/// metres). The file is written under another name and then renamed: it appears whole or not at all. talus/raster_output.hpp
/// writes meshes as rasters and pictures.
///
/// returns  how far the file's surface may lie from the mesh's, for .glb stores floats: add it to an answer's bound
/// fails    invalid_argument: another ending, or a mesh whose numbers do not fit; unsupported; io, full
Metres write_mesh(const Mesh& mesh, const Description& description, const std::filesystem::path& file);

}  // namespace talus
