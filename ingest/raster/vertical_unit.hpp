#pragma once
// Words for vertical units.

#include <optional>
#include <string>
#include <string_view>

namespace talus {

/// Metres in the unit that files, CRSs and the command line call so, in any case of letters; none if Talus does
/// not know the word. The empty word is the metre.
[[nodiscard]] std::optional<double> metres_in(std::string_view unit);

}  // namespace talus
