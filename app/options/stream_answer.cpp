#include "app/options/stream_answer.hpp"

#include <utility>
#include <variant>

#include <fmt/format.h>

#include "talus/failure.hpp"

namespace talus::app {

RestrictedQuadtree answer_of(Stream& stream, const std::string& file) {
  if (auto* answer = std::get_if<RestrictedQuadtree>(&stream.content)) return std::move(*answer);
  const auto& increment = std::get<Increment>(stream.content);
  throw Failure(Cause::invalid_argument,
                fmt::format("{} is an increment, from {} m to {} m, and no answer: merge it into one first", file,
                            increment.from.value, increment.added.tolerance.value),
                file);
}

}  // namespace talus::app
