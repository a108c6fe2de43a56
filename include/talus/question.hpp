#pragma once
// What can be asked of a snapshot.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "talus/description.hpp"
#include "talus/quadtree.hpp"
#include "talus/units.hpp"

namespace talus {

/// A tolerance that varies from sample to sample. Threads: several may look at one at once.
class ToleranceField {
 public:
  virtual ~ToleranceField() = default;
  /// At a sample. Metres, >= 0, infinity allowed.
  [[nodiscard]] virtual double at(GridPoint p) const = 0;
  /// No more than the smallest of all samples of a rectangle, which may leave the extent. The closer, the fewer
  /// vertices. Called from several threads.
  [[nodiscard]] virtual double least(GridRect rect) const = 0;
};

/// Grows in proportion to the distance on the ground from a point in CRS coordinates, as ground looks from there. The
/// cell's size is taken where the point is.
/// fails  invalid_argument: numbers that are none, a tolerance or growth below 0, a point outside the raster or beyond
///        where the CRS has a ground (latitudes)
[[nodiscard]] std::shared_ptr<const ToleranceField> focus_tolerance(const Description& description, double x, double y,
                                                                    double metres_per_metre, Metres at_focus);

/// One tolerance a patch: `cols` × `rows` patches over a region, as equal as whole samples allow, row by row from the
/// north-west. Samples beyond the region have infinity.
/// fails  invalid_argument: another number of metres than patches, negative or none; more patches than samples
[[nodiscard]] std::shared_ptr<const ToleranceField> patch_tolerance(GridRect region, std::int32_t cols,
                                                                    std::int32_t rows, std::vector<double> metres);

/// One tolerance a cell of a raster: each sample of a region has that of the cell it lies in, on the line between two
/// that of the next one. The outermost cells reach one sample further, so that a raster over the very rectangle that
/// was asked for will do. Samples beyond the region have infinity.
///
/// cells   where the cells' centres are in the database's CRS, by column and row of `metres`
/// metres  cells in which no sample lies are not looked at
/// fails   invalid_argument: a sample in no cell; a cell that is void, negative or no number; names it
[[nodiscard]] std::shared_ptr<const ToleranceField> raster_tolerance(const Description& description, GridRect region,
                                                                     const GridMapping& cells,
                                                                     const SampleWindow& metres);

/// The samples nearest to points, for Question::points; of two that are as near, the one to the east or south.
/// returns  as many, in their order
/// fails    invalid_argument: a coordinate that is no finite number; a point whose sample is not in the region
[[nodiscard]] std::vector<GridPoint> samples_nearest(const Description& description, GridRect region,
                                                     std::span<const Position> points);

/// The samples nearest to a line that is straight between its points: one a step along the longer axis of each part,
/// and those nearest to its ends. Each is a neighbour of the one before, on the grid or across a cell. As vertices they
/// hold the surface to the samples along the line; edges need not follow it. A sample that the line comes back to
/// stands where it came first.
/// fails  invalid_argument: fewer than two points; as samples_nearest
/// cost   time in proportion to the line's steps; memory to the samples returned, at most 8 bytes and a bit for each of
///        the region's
[[nodiscard]] std::vector<GridPoint> samples_along(const Description& description, GridRect region,
                                                   std::span<const Position> line);
/// Of several lines, each sample once.
[[nodiscard]] std::vector<GridPoint> samples_along(const Description& description, GridRect region,
                                                   std::span<const std::vector<Position>> lines);

/// Most vertices and triangles that an answer may have; 0: any number.
struct Budget {
  std::uint64_t vertices = 0, triangles = 0;
};

/// Which heights the vertices of an answer have. The bound holds for all of them.
enum class HeightKind : std::uint8_t {
  exact,  ///< those of the source, bit for bit
  /// Multiples of a quantum, so that a stream needs fewer bits. Every sample is held against the surface with these
  /// heights. Without a quantum of the caller's one about as large as the tolerance is chosen, a triangle is split only
  /// where a sample lies beyond the tolerance, and the answer mostly has fewer vertices than the exact one. With a
  /// quantum the answer is the exact one at the tolerance less what rounding costs, rounded: it has more vertices, and
  /// increments of the same quantum go on from it.
  bounded,
  /// Multiples of a quantum, moved within the tolerance to where most triangles can stay: the fewest vertices. On rough
  /// ground, at five height steps and more, 16 to 26 % fewer than exact. Without a quantum it is half the tolerance; a
  /// smaller one mostly needs fewer vertices, and more bytes.
  /// source  relaxation of linear inequalities: Agmon 1954, Motzkin and Schoenberg 1954
  fitted,
  /// Multiples of the largest quantum that the tolerance allows. Only samples exactly between others are left out: the
  /// most vertices, and the fewest bytes where a mesh would need most samples anyway, which is up to some ten height
  /// steps on rough ground.
  dense
};

struct Heights {
  HeightKind kind = HeightKind::exact;
  Metres quantum{0};  ///< heights are multiples of it, metres > 0, for bounded and fitted; 0: see HeightKind
};

/// What an answer may need at most; 0: any amount. What needs more ends with Cause::too_large as soon as that shows.
struct Limits {
  /// Bytes that the answer and what is kept to make it take. Decoded pages come on top: OpenOptions::cache_bytes bounds
  /// them.
  std::uint64_t memory_bytes = 0;
  std::uint64_t vertices = 0;  ///< vertices of the answer
};

/// One question. A default-made one asks for the whole raster at tolerance 0; each field that is set asks for more.
/// Which fields do not go together: docs/questions.md.
///
/// A question is a value. Several threads may ask the same one at once, if its field, progress and neighbours allow it.
struct Question {
  // ---- where ----
  /// Samples that are answered, within the extent. As it is by default: the whole raster, or what `rectangle` covers.
  GridRect region{{0, 0}, {-1, -1}};
  /// The same in CRS coordinates: the samples that Snapshot::region() says.
  std::optional<Rectangle> rectangle = {};

  // ---- how exact ----
  Metres tolerance{0};  ///< >= 0, infinity allowed
  /// Instead of a tolerance: the smallest one (to within 0.6 %) whose exact answer fits. The search is exact, without
  /// trial: it reads the pages with the largest errors until no other can matter. Answer::search is its cost. A budget
  /// that the region's border alone exceeds is refused with what it needs.
  Budget budget = {};
  std::shared_ptr<const ToleranceField> field = {};  ///< one tolerance a sample; `tolerance` then counts for nothing

  /// A coarser tolerance whose answer the caller has: the answer then holds only what that one lacks, see
  /// increment_of().
  std::optional<Metres> from = {};
  Border border = Border::constrain;
  Heights heights = {};
  /// No vertex of a finer level, save where the border needs it; the answer's bound says what that costs. Level 0 is
  /// the coarsest: one vertex amid the root square.
  std::optional<int> max_level = {};

  // ---- what must be in it ----
  /// Samples of the region that must be vertices, whatever their error. A void one cannot be: it is counted in
  /// Answer::void_points and otherwise as if nobody had asked for it.
  std::vector<GridPoint> points = {};
  std::vector<Position> places = {};              ///< the same by CRS coordinates, see samples_nearest()
  std::vector<std::vector<Position>> lines = {};  ///< and along lines, see samples_along()
  /// Answers that this one is to meet, each where it shares a side or a part of one with the region: its vertices there
  /// become vertices here, with all they depend on. Whole answers of this state of the database with a constrained
  /// border; they need to live as long as the call.
  std::vector<const RestrictedQuadtree*> neighbours = {};

  // ---- how it is worked on: none of these changes an answer ----
  /// Threads for a region of about a million samples or more, where no field, border, point or neighbour is asked for;
  /// 0: OpenOptions::threads.
  int threads = 0;
  std::stop_token stop = {};  ///< ends the work within a page or some thousand triangles, with Cause::cancelled
  /// Called now and then from the asking thread: share of the work that is done, 0 to 1, and what is being done. May
  /// throw to end the work; ask() then throws the same.
  std::function<void(double fraction, const char* stage)> progress = {};
  Limits limits = {};
};

/// Refuses two things in one question that do not go together, naming both; needs no database. docs/questions.md has
/// the table. Snapshot::ask does the same.
/// fails  invalid_argument
void require_combinable(const Question& question);

/// A region that grows outward to multiples of `samples` from grid point (0, 0), and ends with the extent: borders on
/// multiples of 16 need few vertices of their own.
/// fails  invalid_argument: fewer than 1
[[nodiscard]] GridRect snapped(GridRect region, std::int32_t samples, GridRect extent);

/// The finest level that a raster has: vertices of spacing 1.
[[nodiscard]] int finest_level(GridRect extent);

}  // namespace talus
