#include "app/options/stream_options.hpp"

#include <cmath>

#include <fmt/format.h>

#include "app/options/arguments.hpp"
#include "talus/failure.hpp"

namespace talus::app {

void add_stream_words(CLI::App* command, StreamOptions& options) {
  command
      ->add_option("--bands", options.stripes,
                   "Of .rqt files: pieces of each level that several threads can read at once; 0: one for\n"
                   "each 65,536 vertices")
      ->transform(whole())
      ->check(CLI::Range(0, 4096))
      ->option_text("N [0]");
}

void add_height_words(CLI::App* command, HeightWords& words) {
  command
      ->add_option("--heights", words.kind,
                   "exact: the source's own; bounded: multiples of a quantum, within the tolerance all the same,\n"
                   "which make .rqt files smaller; fitted: moved within the tolerance to where fewest vertices are\n"
                   "needed; dense: nearly every sample, rounded as far as the tolerance allows, smaller still where a\n"
                   "mesh would need most of them")
      ->option_text("exact|bounded|fitted|dense [exact]");
  command
      ->add_option("--quantum", words.quantum,
                   "Of bounded heights, so that increments of the same quantum can go on from the answer; without\n"
                   "it one is chosen, with fewer vertices, and nothing goes on from the answer. Of fitted heights: a\n"
                   "smaller one mostly needs fewer vertices, and more bytes; without it half the tolerance")
      ->option_text("M");
}

Heights HeightWords::heights() const {
  Heights heights;
  if (kind == "bounded") {
    heights.kind = HeightKind::bounded;
  } else if (kind == "fitted") {
    heights.kind = HeightKind::fitted;
  } else if (kind == "dense") {
    heights.kind = HeightKind::dense;
  } else if (kind != "exact") {
    throw Failure(Cause::invalid_argument,
                  fmt::format("--heights takes exact, bounded, fitted or dense; \"{}\" is none of them", kind));
  }
  if (quantum.empty()) return heights;
  heights.quantum = parse_tolerance(quantum, "--quantum");
  if (!(heights.quantum.value > 0) || !std::isfinite(heights.quantum.value))
    throw Failure(Cause::invalid_argument, fmt::format("--quantum takes metres above 0; \"{}\" is not that", quantum));
  return heights;
}

}  // namespace talus::app
