#pragma once
// The library names fields of its options; people type options of the command line.

#include <string>
#include <vector>

namespace talus::app {

/// A sentence of the library with each field it names, such as `InputOptions::allow_outside`, as the option that sets
/// it.
[[nodiscard]] std::string with_options(std::string sentence);
[[nodiscard]] std::vector<std::string> with_options(std::vector<std::string> sentences);

}  // namespace talus::app
