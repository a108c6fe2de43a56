#pragma once
// What a client has, and what it lacks of what it asks for next.

#include <cstdint>
#include <vector>

#include "talus/database.hpp"
#include "talus/increment.hpp"

namespace talus {

/// The way from what a client has to what it asked for.
struct Difference {
  /// The client has nothing of use: it drops all it has. Otherwise it has the answer of `region_before` at
  /// `added.from`.
  bool starts_over = true;
  GridRect region_before{{0, 0}, {-1, -1}};
  /// `added` is an increment and there is nothing else: the tolerance fell, the region stayed.
  bool is_increment = false;
  /// Vertices that the client lacks. Unless `is_increment`, its tolerance may be any, and its level errors are those of
  /// the whole answer.
  Increment added;
  /// Vertices of the client within the new region that the answer lacks, row by row. Those outside it go unnamed.
  std::vector<GridPoint> removed;
  /// The session remembers what the client now has; otherwise the next difference starts over.
  bool remembered = true;
};

/// What the client has afterwards: the answer of the region at the tolerance, bit for bit.
///
/// client  what the differences so far have led to; anything where the difference starts over
/// fails   invalid_argument: a client that has something else
[[nodiscard]] RestrictedQuadtree apply(const RestrictedQuadtree& client, const Difference& difference);

/// Remembers what one client has.
///
/// Threads: one at a time.
///
/// Memory between questions: twelve bytes for each 64 samples in a row of the region, see `bytes`. A session
/// whose client has more than it may remember forgets all of it, which the difference says; nothing fails. During a
/// question there are two such masks, and the answer.
class Session {
 public:
  /// most_bytes  to remember; 0: every difference starts over
  explicit Session(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// What the client lacks of an answer. A tolerance that falls in one region costs what its increment costs; anything
  /// else what the answer costs, of which only what is new is handed out. A client of another state of the database, or
  /// of another database, starts over.
  /// fails  as Snapshot::ask; the client then has what it had
  [[nodiscard]] Difference next(const Snapshot& now, GridRect region, Metres tolerance);

  /// The client lost what it had.
  void forget();
  /// Remembered at present.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  std::uint64_t most_bytes_;
  bool knows_ = false;
  Origin origin_;
  Metres tolerance_;
  VertexMask vertices_;
};

}  // namespace talus
