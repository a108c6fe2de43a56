#pragma once
// Answers whose heights are multiples of a quantum, within the tolerance.

#include <optional>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"

namespace talus {

/// A question for rounded heights.
struct RoundedQuestion {
  const StoredPages& pages;
  GridRect region;
  Metres tolerance;
  std::optional<Metres> from;  ///< tolerance of an increment's base; only for bounded heights with a quantum
  int threads = 1;
  Watch& watch;
};

/// The largest distance in metres from a height to the nearest multiple of a quantum: half of it, or less if heights
/// are whole numbers of a step that divides it.
[[nodiscard]] double rounding_of(const Description& description, Metres quantum);

/// The largest quantum that still leaves most of a tolerance to the surface: about the tolerance, an odd number of
/// height steps.
[[nodiscard]] Metres quantum_for(const Description& description, Metres tolerance);

/// The largest quantum that rounds by at most the tolerance minus the database's loss: an odd number of height steps,
/// or twice that tolerance if heights have none; 0: nothing is left for rounding.
[[nodiscard]] Metres dense_quantum(const Description& description, Metres tolerance);

/// Answers an accepted question with a known tolerance whose heights are not exact. See HeightKind.
/// fails  as Snapshot::ask
[[nodiscard]] Answer rounded_answer(const RoundedQuestion& question, Heights heights);

}  // namespace talus
