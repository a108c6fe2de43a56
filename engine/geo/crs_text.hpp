#pragma once
// What the text of a CRS says, read without a library: streams carry the text alone.

#include <string_view>

#include "talus/description.hpp"

namespace talus {

/// Reads WKT 1 and WKT 2 of projected, geographic and compound coordinate systems.
///
/// returns  the defaults of CrsFacts, with the name if there is one, for text that it does not understand
/// cost     linear; brackets nested deeper than 64 are not understood
[[nodiscard]] CrsFacts facts_of_wkt(std::string_view wkt);

}  // namespace talus
