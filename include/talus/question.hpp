#pragma once
// Question: everything that can be asked of a snapshot.

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

/// A tolerance that varies from sample to sample. Threads: any number may read one at once.
class ToleranceField {
 public:
  virtual ~ToleranceField() = default;
  /// The tolerance at a sample, >= 0; infinity is allowed.
  [[nodiscard]] virtual Metres at(GridPoint p) const = 0;
  /// A lower bound of the tolerance in a rectangle, which may leave the extent. A closer bound gives fewer vertices.
  /// Called from several threads at once.
  [[nodiscard]] virtual Metres least(GridRect rect) const = 0;
};

/// A tolerance that grows with the distance on the ground from a point (CRS coordinates): `at_focus` plus
/// `metres_per_metre` times the distance. It measures distances with the size of a cell at the point.
/// fails  invalid_argument: a number that is not finite; a tolerance or growth below 0; a point outside the raster or
///        beyond a pole
[[nodiscard]] std::shared_ptr<const ToleranceField> focus_tolerance(const Description& description, double x, double y,
                                                                    double metres_per_metre, Metres at_focus);

/// One tolerance for each of `cols` × `rows` patches of a region, row by row from the north-west. Patches are as equal
/// as whole samples allow. Samples outside the region have infinity.
/// fails  invalid_argument: not one value a patch; a value that is negative or NaN; more patches than samples
[[nodiscard]] std::shared_ptr<const ToleranceField> patch_tolerance(GridRect region, std::int32_t cols,
                                                                    std::int32_t rows, std::vector<double> metres);

/// A tolerance from a raster: a sample has the value of the cell that it lies in. On the line between two cells the
/// second one counts. The outermost cells reach one sample further, so a raster of exactly the asked rectangle fits.
/// Samples outside the region have infinity.
///
/// cells   position of the cells' centres in the database's CRS, by column and row of `metres`
/// metres  one tolerance a cell; cells without a sample are ignored
/// fails   invalid_argument, naming the cell or sample: a sample outside all cells; a void, negative or NaN cell
[[nodiscard]] std::shared_ptr<const ToleranceField> raster_tolerance(const Description& description, GridRect region,
                                                                     const GridMapping& cells,
                                                                     const SampleWindow& metres);

/// The sample nearest to each point, for Question::points. Of two equally near ones, the eastern or southern one.
/// returns  one sample a point, in their order
/// fails    invalid_argument: a coordinate that is not finite; a nearest sample outside the region
[[nodiscard]] std::vector<GridPoint> samples_nearest(const Description& description, GridRect region,
                                                     std::span<const Position> points);

/// The samples along a line with straight parts: one for each step along the longer axis of a part, and the nearest to
/// its ends. Each is a neighbour of the one before, diagonals included, and occurs once. As vertices they keep the
/// surface on the samples along the line; mesh edges need not follow the line.
/// fails  invalid_argument: fewer than two points; as samples_nearest
/// cost   time linear in the steps; memory for the result, at most 8 bytes and a bit for each sample of the region
[[nodiscard]] std::vector<GridPoint> samples_along(const Description& description, GridRect region,
                                                   std::span<const Position> line);
/// The samples along several lines, each once.
[[nodiscard]] std::vector<GridPoint> samples_along(const Description& description, GridRect region,
                                                   std::span<const std::vector<Position>> lines);

/// The most vertices and triangles of an answer; 0: any number.
struct Budget {
  std::uint64_t vertices = 0, triangles = 0;
};

/// The heights of an answer's vertices. The bound holds for every kind.
enum class HeightKind : std::uint8_t {
  exact,  ///< the source's heights, bit for bit
  /// Heights are multiples of a quantum, so a stream needs fewer bits. Quantum 0: Talus chooses one near the tolerance
  /// and measures every sample against the moved surface; the answer mostly has fewer vertices than the exact one.
  /// Quantum > 0: the exact answer at (tolerance minus rounding), rounded. It has more vertices; increments with the
  /// same quantum can follow.
  bounded,
  /// Heights are multiples of a quantum, moved within the tolerance so that the fewest vertices are needed: 16 to 26 %
  /// fewer than exact on rough ground, at five height steps or more. Quantum 0: half of the tolerance. A smaller one
  /// mostly needs fewer vertices and more bytes.
  /// source  relaxation of linear inequalities: Agmon 1954, Motzkin and Schoenberg 1954
  fitted,
  /// Heights are multiples of the largest quantum that the tolerance allows, at nearly every sample: the most vertices.
  /// It has the fewest bytes where a mesh needs most samples anyway: up to some ten height steps on rough ground.
  dense
};

struct Heights {
  HeightKind kind = HeightKind::exact;
  Metres quantum{0};  ///< > 0, for bounded and fitted; 0: chosen by Talus, see HeightKind
};

/// The most that an answer may need; 0: any amount. A larger one fails with Cause::too_large as soon as that is known.
struct Limits {
  /// Bytes of the answer and of the work on it. Decoded pages come on top, see OpenOptions::cache_bytes.
  std::uint64_t memory_bytes = 0;
  std::uint64_t vertices = 0;  ///< of the answer; with Question::from, of the increment alone
};

/// One question. By default it asks for the whole raster at tolerance 0. share/doc/talus/questions.md lists the fields
/// that cannot be combined. Several threads may ask the same Question at once if its field, progress and neighbours allow that.
struct Question {
  // ---- where ----
  /// The region in samples, within the extent. Default: `rectangle`, or the whole raster.
  GridRect region{{0, 0}, {-1, -1}};
  /// The same in CRS coordinates; Snapshot::region() says which samples it has.
  std::optional<Rectangle> rectangle = {};

  // ---- how exact ----
  Metres tolerance{0};  ///< metres, >= 0; infinity is allowed
  /// Use the smallest tolerance (to within 0.6 %) whose answer fits. The search reads the pages with the largest errors
  /// until no other page can change the result; Answer::search is its cost. A budget that the region's border alone
  /// exceeds is refused with invalid_argument. Leave `tolerance` at 0; the answer's is RestrictedQuadtree::tolerance.
  /// Voids count: see Description::void_weight.
  Budget budget = {};
  std::shared_ptr<const ToleranceField> field = {};  ///< one tolerance a sample; `tolerance` is then ignored

  /// A coarser tolerance whose answer the caller has. The answer then has only the missing vertices: increment_of().
  std::optional<Metres> from = {};
  Border border = Border::constrain;
  Heights heights = {};
  /// The finest level of the answer, except where the border needs finer ones. Level 0 is one vertex in the middle of
  /// the root square. The answer's bound grows accordingly.
  std::optional<int> max_level = {};

  // ---- what must be in it ----
  /// Samples of the region that must be vertices, whatever their error. Answer::void_points counts void ones, which
  /// cannot be.
  std::vector<GridPoint> points = {};
  std::vector<Position> places = {};              ///< the same in CRS coordinates, see samples_nearest()
  std::vector<std::vector<Position>> lines = {};  ///< the same along lines, see samples_along()
  /// Answers that share a side, or a part of one, with the region. Their vertices there become vertices here, with all
  /// ancestors. Each is a whole answer of this state of the database with a constrained border. Keep them until ask()
  /// returns.
  std::vector<const RestrictedQuadtree*> neighbours = {};

  // ---- how Talus works on it: does not change the answer ----
  /// Threads, >= 0; 0: OpenOptions::threads. Used from about a million samples on, without field, border, points, neighbours.
  int threads = 0;
  std::stop_token stop = {};  ///< stops within a page or some thousand triangles, with Cause::cancelled
  /// Called now and then by the asking thread, with the share of the work that is done (0 to 1) and its stage. May
  /// throw to stop the work; ask() then throws the same.
  std::function<void(double fraction, const char* stage)> progress = {};
  Limits limits = {};
};

/// Checks that the fields of a question can be combined, as Snapshot::ask does. Needs no database.
/// fails  invalid_argument, naming two fields that cannot; share/doc/talus/questions.md has the table
void require_combinable(const Question& question);

/// A region grown outward to multiples of `samples` from grid point (0, 0), within the extent. Borders on multiples of
/// 16 need few extra vertices.
/// fails  invalid_argument: `samples` < 1
[[nodiscard]] GridRect snapped(GridRect region, std::int32_t samples, GridRect extent);

/// The number of the finest level of a raster, whose vertices have spacing 1.
[[nodiscard]] int finest_level(GridRect extent);

}  // namespace talus
