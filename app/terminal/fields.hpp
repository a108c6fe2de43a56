#pragma once
// Sentences of the library name fields; people type options.

#include <string>
#include <vector>

namespace talus::app {

/// Replaces the names of fields in a sentence, such as `InputOptions::allow_outside`, by the options that set them.
[[nodiscard]] std::string with_options(std::string sentence);
[[nodiscard]] std::vector<std::string> with_options(std::vector<std::string> sentences);

}  // namespace talus::app
