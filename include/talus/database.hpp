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
  std::uint64_t points = 0;          ///< samples that Question::points, places and lines name
  std::uint64_t point_vertices = 0;  ///< vertices that are there for these alone, with all they depend on
  std::uint64_t void_points = 0;     ///< samples of these without data: they are no vertices
  /// As asked. The quadtree then holds only what the answer at this tolerance lacks, which makes no mesh;
  /// increment_of() makes it ready for merge() and streams.
  std::optional<Metres> from = {};
  QueryCost cost;    ///< without `search`
  QueryCost search;  ///< cost of the search for a budget's tolerance, which is quadtree.tolerance; 0 without a budget
};

/// What an answer with Question::from is for merge() and streams.
/// fails  invalid_argument: an answer to a question without `from`
[[nodiscard]] Increment increment_of(Answer answer);

/// Where a rectangle in CRS coordinates lies on the grid.
struct PlacedRectangle {
  GridRect samples;     ///< outward to grid lines, cut at the raster
  Frame frame;          ///< the rectangle itself, grid lines being whole numbers, cut at the outermost samples
  bool is_cut = false;  ///< it reaches farther than the raster's outermost cells, and `samples` leaves that out
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

/// One consistent view of a database: it stays as it was, whatever becomes of the file. Keep it short: as long as one
/// lives, the system cannot reuse the room of a file that has been replaced.
///
/// Threads: several may ask one snapshot at once, and it may move between them.
///
/// In a geographic CRS all questions take longitudes a full turn apart as one place. Each next point of a line is taken
/// on the turn nearest to the one before.
///
/// Every question can fail with out_of_memory, with corrupt for a damaged page, and with io where the file has become
/// shorter or its disk fails.
class Snapshot {
 public:
  ~Snapshot();
  Snapshot(Snapshot&&) noexcept;
  Snapshot& operator=(Snapshot&&) noexcept;

  [[nodiscard]] const Description& description() const;
  [[nodiscard]] StorageSummary storage() const;
  /// What it was made from, which state of the database it is, and how many vertices tolerances select.
  [[nodiscard]] Provenance provenance() const;

  /// The samples that a rectangle covers: outward to grid lines (a coordinate within 10⁻⁶ cell of a line is on it),
  /// then cut at the raster. In a geographic CRS xmin > xmax is the box across the antimeridian, if it is at most half
  /// a turn wide.
  /// fails  invalid_argument: swapped, empty or NaN corners, or nothing in common with the raster; a box at both ends
  ///        of a raster that goes around the globe
  [[nodiscard]] PlacedRectangle region(const Rectangle& rectangle) const;

  /// The restricted quadtree that answers a question. With a region and a tolerance alone: every valid sample under the
  /// surface lies within the tolerance of it, every covered sample of the region lies under it, no triangle leaves the
  /// region, and answers at one tolerance for regions that share a whole side, each at least 16 cells deep across it,
  /// meet without a crack.
  ///
  /// Without voids every sample is covered. Beside voids a sample is covered iff it is a corner of a valid finest
  /// triangle: half a unit cell, cut along the diagonal that joins corners of even column + row, its three corners
  /// data. A coarse triangle that mixes data and void is kept if its longest ground side times Description::void_weight
  /// is within the tolerance; it may stand on void vertices, whose heights are those of samples near them.
  ///
  /// A tolerance below what stored heights can keep (Description::lossy_metres and finest_tolerance) gives the finest
  /// answer there is, and its bound says so. A field's answer holds every covered sample within its own tolerance: a
  /// vertex is left out only if its error is within the least tolerance of its diamond. Two such answers need not meet.
  /// The quadtree of Border::cover and clip holds what its triangles need beyond the region; triangulate() gives
  /// exactly the triangles of the whole raster's answer that meet it. Answers with rounded heights meet
  /// where kind, tolerance and quantum are the same. In a database that keeps the vertices of a tolerance only, answers
  /// at that tolerance and below have the same vertices: an increment between two of them is empty.
  ///
  /// returns  a quadtree whose mesh has no triangles where there are only voids, or the region is one sample wide
  /// fails    invalid_argument: two things that do not go together (docs/questions.md); a region or a point outside; a
  ///          tolerance or level below 0; `from` not above the tolerance; a neighbour of another database or state, or
  ///          one that shares no side; a budget that the border exceeds; rounded heights at a tolerance of 0 or
  ///          infinity, or with a quantum that lies farther from heights than the tolerance, or of which heights are
  ///          more than 10¹⁵ multiples. unsupported: bounded (without a quantum) and fitted heights of a database that
  ///          keeps the vertices of a tolerance only. cancelled, too_large: Question::stop and limits
  /// cost     pages that hold something above the tolerance, their ancestors, and those on odd borders; an increment
  ///          does not read what the border needs. Pages are looked at twice with a field, another border, a level,
  ///          points or neighbours. Bounded heights without a quantum: 9 bytes a sample of the region and a few times
  ///          the time; fitted ones 26 bytes and three to fourteen times; dense ones as exact at tolerance 0
  /// source   [P98 §4, §10], design of the border: docs/architecture.md
  [[nodiscard]] Answer ask(const Question& question) const;

  /// Several questions whose answers meet without a crack wherever two of the regions share a side or a part of one, at
  /// whatever tolerances and however thin they are: vertices there are shared, back and forth until none is missing.
  ///
  /// returns  answers in the order of the questions, none with anything unmatched but by neighbours of its own
  /// fails    as ask
  /// cost     that of ask for each question, and the vertices of all at once
  /// source   [P98 §9]
  [[nodiscard]] std::vector<Answer> ask_together(std::span<const Question> questions) const;

  /// The mesh of the whole raster, or of what a rectangle covers: ask() and triangulate() in one.
  [[nodiscard]] Mesh mesh(Metres tolerance) const;
  [[nodiscard]] Mesh mesh(const Rectangle& rectangle, Metres tolerance) const;

  /// The height at a point in the vertical unit. Without a tolerance it is bilinear between the four samples around the
  /// point. Samples are pixel centres. A point on a line of samples, or within 10⁻⁶ cell of one, needs only the two on
  /// either side along the line; one on a sample needs that sample, and gets its height bit for bit.
  ///
  /// surface  a tolerance: the height is that of the surface that ask() gives for the whole raster at it. So this is
  ///          what a mesh shows there, and within the tolerance of covered samples. Any database has surfaces
  /// returns  nothing where a sample that is needed is void, where no triangle of the surface is, outside the extent,
  ///          or where a coordinate is not a finite number
  /// fails    unsupported: without a tolerance, a database that keeps the vertices of a tolerance only;
  ///          invalid_argument: the tolerance
  /// cost     a few pages, and for the first surface of a snapshot the border's vertices, in proportion to the extent's
  ///          sides
  [[nodiscard]] std::optional<double> height(double x, double y, std::optional<Metres> surface = {}) const;
  /// Many points at once, answers in their order: each page is decoded once, however the points are strewn.
  /// out    as many places as there are points
  /// fails  as height; invalid_argument: another number of places
  /// cost   where the pages are decoded half a microsecond a point, one to two on a surface
  QueryCost heights(std::span<const Position> points, std::span<std::optional<double>> out,
                    std::optional<Metres> surface = {}) const;

  /// The height along a line through two or more points, straight between them in CRS coordinates. Half of the
  /// tolerance goes to the surface whose every triangle under the line is cut, and what its bound leaves of the whole
  /// to leaving out vertices of that cut, so that the profile is within the tolerance of covered samples on the line.
  /// The line's points and the ends of parts stay. It ends and begins anew where no triangle is: beside data, outside
  /// the extent; where it touches a triangle in one point it has no part.
  /// fails  invalid_argument: fewer than two points, all at one place, a coordinate that is not a finite number, the
  ///        tolerance
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

/// The saturated errors of an answer's vertices, by rank, in metres; infinity for root corners. For Progression.
///
/// fails  invalid_argument: vertices outside the extent; corrupt for a damaged page, or a vertex without one
/// cost   the pages with these vertices
[[nodiscard]] std::vector<double> errors_of(const Snapshot& now, const RestrictedQuadtree& answer);

/// Whether a point lies among the samples, on the outermost ones included: no question has an answer beyond.
[[nodiscard]] bool is_inside(const Snapshot& now, Position point);

struct OpenOptions {
  /// Most bytes of decoded pages that are kept for the next question, at 14 to 20 bytes a sample. 0: none is kept.
  std::uint64_t cache_bytes = std::uint64_t{64} << 20;
  /// Threads of a question that does not say how many; 0: one a core. Answers do not depend on it.
  int threads = 0;
};

/// An open database file. Copies share one environment and one cache; a file is opened once per process.
///
/// A database file is never changed in place: update() and compact() write a new file and give it the name in one step.
/// Who has opened the old file keeps it, with its snapshots and those made later: every answer comes from the state
/// that was opened, even after the name has gone to another file or to none. is_current() says whether the name still
/// leads there; reopen() opens what it leads to now. The system frees the old file when the last Database, copy or
/// Snapshot of it is gone. Another program that writes into the file or cuts it short breaks this: questions then fail
/// with corrupt or io.
///
/// Threads: all may be called from several threads at once; a Database object that one thread assigns to is the
/// exception.
class Database {
 public:
  /// fails  not_found; corrupt: not a database or a damaged header; unsupported: another version; out_of_memory
  [[nodiscard]] static Database open(const std::filesystem::path& file, const OpenOptions& options = {});
  [[nodiscard]] Snapshot snapshot() const;

  /// Whether the file that has the name now is the one that is open. False if there is none.
  /// cost  one look at the name
  [[nodiscard]] bool is_current() const;
  /// What has the name now, opened with the same options; the same as a copy where that is still the file that is open.
  /// This one, its copies and their snapshots keep what they see.
  /// fails  as open
  [[nodiscard]] Database reopen() const;

 private:
  struct Opened;
  explicit Database(std::shared_ptr<Opened> opened);
  std::shared_ptr<Opened> opened_;
};

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
  std::uint64_t covered_samples = 0, uncovered_samples = 0;  ///< see Snapshot::ask; none may be uncovered
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
