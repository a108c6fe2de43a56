#include "app/stream_options.hpp"

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus::app {

void add_stream_words(CLI::App* command, StreamWords& words) {
  command
      ->add_option("--profile", words.profile,
                   "Of .rqt files, which hold the same in each: fast is read fastest, balanced is a fifth\n"
                   "smaller, small is smallest and slow")
      ->option_text("fast|balanced|small [balanced]");
  command
      ->add_option("--bands", words.bands,
                   "Of .rqt files: pieces of each level that several threads can read at once; 0: one for\n"
                   "each 65,536 vertices")
      ->check(CLI::Range(0, 4096))
      ->option_text("N [0]");
}

StreamOptions stream_options(const StreamWords& words, int threads) {
  StreamOptions options;
  options.bands = words.bands;
  options.threads = threads;
  if (words.profile == "fast") {
    options.profile = StreamProfile::fast;
  } else if (words.profile == "small") {
    options.profile = StreamProfile::small;
  } else if (words.profile != "balanced") {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--profile takes fast, balanced or small; \"{}\" is none of them", words.profile));
  }
  return options;
}

std::string spelled(StreamProfile profile) {
  return profile == StreamProfile::fast ? "fast" : profile == StreamProfile::small ? "small" : "balanced";
}

}  // namespace talus::app
