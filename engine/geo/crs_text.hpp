#pragma once
// Reads the text of a CRS without PROJ, because a stream contains only this text.

#include <string_view>

#include "talus/description.hpp"

namespace talus {

/// The facts in WKT 1 or WKT 2 of a projected, geographic or compound CRS.
///
/// returns  for a text that it does not understand: default CrsFacts, with the name if there is one
/// cost     linear; brackets nested deeper than 64 are not understood
[[nodiscard]] CrsFacts facts_of_wkt(std::string_view wkt);

}  // namespace talus
