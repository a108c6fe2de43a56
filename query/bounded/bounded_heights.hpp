#pragma once
// Answers whose heights are multiples of a quantum, and still within the tolerance.

#include "talus/database.hpp"

namespace talus {

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

/// See Snapshot::bounded.
[[nodiscard]] Answer bounded_answer(const Snapshot& now, GridRect region, Metres tolerance, Metres quantum);

/// See Snapshot::fitted.
[[nodiscard]] Answer fitted_answer(const Snapshot& now, GridRect region, Metres tolerance, Metres quantum);

/// See Snapshot::dense.
[[nodiscard]] Answer dense_answer(const Snapshot& now, GridRect region, Metres tolerance);

/// See Snapshot::quantised.
[[nodiscard]] Answer quantised_answer(const Snapshot& now, GridRect region, Metres tolerance, Metres quantum);
[[nodiscard]] Increment quantised_increment(const Snapshot& now, GridRect region, Metres from, Metres to,
                                            Metres quantum);

}  // namespace talus
