#pragma once
// Answers whose heights are multiples of a quantum, and still within the tolerance.

#include <optional>

#include "query/pages/stored_pages.hpp"
#include "query/pages/watch.hpp"

namespace talus {

/// What answers with rounded heights are made from.
struct RoundedQuestion {
  const StoredPages& pages;
  GridRect region;
  Metres tolerance;
  std::optional<Metres> from;  ///< of an increment; only bounded heights with a quantum have one
  int threads = 1;
  Watch& watch;
};

/// How far a height can lie from the nearest multiple of a quantum, in metres: half of it, or less where heights are
/// whole numbers of a step that divides it.
[[nodiscard]] double rounding_of(const Description& description, Metres quantum);

/// The largest quantum that leaves most of a tolerance to the surface: about as large as the tolerance, an odd number
/// of height steps.
[[nodiscard]] Metres quantum_for(const Description& description, Metres tolerance);

/// The largest quantum that rounds heights by no more than a tolerance, less what the database has lost already: an odd
/// number of height steps, or twice the tolerance where heights have none; 0: nothing is left to
/// round by.
[[nodiscard]] Metres dense_quantum(const Description& description, Metres tolerance);

/// An accepted question whose heights are not exact, its tolerance known. See HeightKind.
/// fails  as Snapshot::ask
[[nodiscard]] Answer rounded_answer(const RoundedQuestion& question, Heights heights);

}  // namespace talus
