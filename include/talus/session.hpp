#pragma once
// Sessions: what a client has, and what it lacks of its next answer.

#include <cstdint>
#include <vector>

#include "talus/database.hpp"
#include "talus/increment.hpp"

namespace talus {

/// How a client gets from its present answer to the next one.
struct Difference {
  /// The client drops everything it has. If false, it has the answer of `region_before` at `added.from`.
  bool starts_over = true;
  GridRect region_before{{0, 0}, {-1, -1}};
  /// Only the tolerance fell: `added` is an increment, the region is the same and nothing is removed.
  bool is_increment = false;
  /// Vertices that the client lacks. Unless `is_increment`, `from` may be any tolerance, and the level errors are those
  /// of the whole answer.
  Increment added;
  /// Vertices of the client in the new region that the answer lacks, row by row. Those outside are not listed.
  std::vector<GridPoint> removed;
  /// The session remembers this answer. If false, the next difference starts over.
  bool remembered = true;
};

/// The client's new answer. It equals Snapshot::ask for the new region and tolerance bit for bit.
///
/// client  the result of all earlier differences; any value if `difference.starts_over`
/// fails   invalid_argument: the client has another answer
[[nodiscard]] RestrictedQuadtree apply(const RestrictedQuadtree& client, const Difference& difference);

/// Remembers the vertices of one client.
///
/// Threads: one at a time. Memory: 12 bytes for each 64 samples in a row of the region, see bytes(); twice that and the
/// answer during a question. An answer that would need more than `most_bytes` is forgotten (Difference::remembered).
class Session {
 public:
  /// most_bytes  memory limit; 0: every difference starts over
  explicit Session(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// What the client lacks of the answer to (region, tolerance). For a finer tolerance in the same region it costs as
  /// much as an increment, else as much as the whole answer. After a change of the database the client starts over.
  /// fails  as Snapshot::ask; the session is then unchanged
  [[nodiscard]] Difference next(const Snapshot& now, GridRect region, Metres tolerance);

  /// Call this when the client has lost its answer.
  void forget();
  /// Memory in use at present.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  std::uint64_t most_bytes_;
  bool knows_ = false;
  Origin origin_;
  Metres tolerance_;
  VertexMask vertices_;
};

}  // namespace talus
