#pragma once
// Names of vertical units.

#include <optional>
#include <string>
#include <string_view>

namespace talus {

/// Metres per unit, by the unit's name in files, CRSs and options, in any letter case; empty if it is unknown. An empty
/// name is the metre.
[[nodiscard]] std::optional<double> metres_in(std::string_view unit);

}  // namespace talus
