#include "app/terminal/say.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <utility>

#include <unistd.h>

#include "app/terminal/fields.hpp"

namespace talus::app {
namespace {

volatile std::sig_atomic_t line_is_open = 0;

}  // namespace

void write_to_log(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;  // nobody reads it
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void say(std::string sentence) {
  sentence = "talus: " + with_options(std::move(sentence));
  // A file name may hold a line feed.
  std::replace_if(
      sentence.begin(), sentence.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  end_progress();
  write_to_log(sentence + "\n");
}

void note(const std::string& sentence) { say("note: " + sentence); }

void notes(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) note(sentence);
}

void show_progress(std::string_view line) {
  line_is_open = 1;
  write_to_log("\r" + std::string(line) + "\x1b[K");
}

void end_progress() noexcept {
  if (line_is_open == 0) return;
  line_is_open = 0;
  write_to_log("\n");
}

}  // namespace talus::app
