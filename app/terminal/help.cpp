#include "app/terminal/help.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace talus::app {
namespace {

/// Adds one line to `text`, whose last line is `at` letters long. Lines after the first begin with `indent` blanks.
void fold(std::string& text, std::size_t at, std::string_view line, std::size_t width, std::size_t indent,
          std::string_view broken = "") {
  bool is_first = true;
  while (!line.empty()) {
    const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
    std::size_t end = std::min(line.find(' ', begin), line.size());
    // An option keeps its value.
    if (line[begin] == '-' && end > begin + 1 && end + 1 < line.size() && std::isalnum(line[end + 1]) != 0)
      end = std::min(line.find(' ', end + 1), line.size());
    const std::string_view blanks = line.substr(0, begin), word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    if (!is_first && at + blanks.size() + word.size() + (line.empty() ? 0 : broken.size()) > width) {
      text += fmt::format("{}\n{:{}}{}", broken, "", indent, word);
      at = indent + word.size();
    } else {
      text.append(blanks).append(word);
      at += blanks.size() + word.size();
    }
    is_first = false;
  }
  text += '\n';
}

/// Two columns. A left one that is too long has a line of its own.
std::string row(const std::string& left, const std::string& right, std::size_t width) {
  const std::size_t column = std::min<std::size_t>(24, width / 4 + 4);
  std::string text;
  fold(text, 0, "  " + left, width, 6);
  if (left.size() + 4 <= column) text.back() = ' ';  // the right one goes on here
  std::string lines = folded(right, width, column);
  if (left.size() + 4 <= column) lines.erase(0, text.size());
  return text + lines;
}

std::string usage(const CLI::App& app, const std::string& name) {
  std::string text = "Usage: " + name;
  for (const bool positional : {true, false}) {
    for (const CLI::Option* option : app.get_options()) {
      if (option->get_positional() != positional || !(option->get_required() || positional)) continue;
      const std::string& word = option->get_option_text();
      text += positional ? option->get_required() ? " " + word : " [" + word + "]"
                         : fmt::format(" {} {}", option->get_name(), word);
    }
  }
  return text + (app.get_require_subcommand_min() > 0 ? " COMMAND" : "") + " [OPTIONS]";
}

std::string left_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_option_text();
  std::string names = option.get_name(false, true);
  if (const std::size_t comma = names.find(','); comma != std::string::npos) names.insert(comma + 1, " ");
  return option.get_option_text().empty() ? names : names + " " + option.get_option_text();
}

}  // namespace

std::size_t help_width() {
  std::size_t width = 0;
  const char* const said = std::getenv("COLUMNS");
  const std::string_view word = said == nullptr ? "" : said;
  winsize window{};
  if (std::from_chars(word.data(), word.data() + word.size(), width).ec != std::errc{} || width == 0)
    width = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0 ? window.ws_col : 80;
  return std::clamp<std::size_t>(width, 40, 120);
}

std::string folded(const std::string& text, std::size_t width, std::size_t indent) {
  std::string lines;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string_view line = std::string_view(text).substr(from, end - from);
    const std::size_t begin = std::min(line.find_first_not_of(' '), line.size()), gap = line.find("  ", begin);
    const std::size_t second = gap == std::string_view::npos ? begin : line.find_first_not_of(' ', gap);
    if (!line.empty()) lines.append(indent, ' ');
    if (line.starts_with("  talus")) {
      fold(lines, indent, line, width, indent + 6, " \\");
    } else {
      fold(lines, indent, line, width, indent + second);
    }
    from = end + 1;
  }
  return lines;
}

std::string Help::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode /*mode*/) const {
  const std::size_t width = help_width();
  std::string text = folded(app->get_description(), width) + "\n";
  fold(text, 0, usage(*app, name), width, 7);
  for (const std::string& group : app->get_groups()) {
    text += "\n" + group + ":\n";
    for (const CLI::Option* option : app->get_options()) {
      if (option->get_group() == group) text += row(left_of(*option), option->get_description(), width);
    }
  }
  const auto commands = app->get_subcommands({});
  if (!commands.empty()) text += "\nSubcommands:\n";
  for (const CLI::App* command : commands) text += row(command->get_name(), command->get_description(), width);
  return app->get_footer().empty() ? text : text + "\n" + folded(app->get_footer(), width);
}

}  // namespace talus::app
