#pragma once
// Help that is as wide as the terminal.

#include <cstddef>
#include <string>

#include <CLI/CLI.hpp>

namespace talus::app {

/// COLUMNS, or the width of the terminal, or 80; from 40 to 120.
[[nodiscard]] std::size_t help_width();

/// Lines of at most `width` letters. A line feed in the text ends a line. A line that begins with "  talus" is a
/// command: where it is broken it ends in a backslash, so that a shell reads it. In a line with two columns the second
/// one stays a column.
/// indent  before each line
[[nodiscard]] std::string folded(const std::string& text, std::size_t width, std::size_t indent = 0);

/// Usage, then the groups of options in the order in which they were added.
class Help : public CLI::FormatterBase {
 public:
  [[nodiscard]] std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace talus::app
