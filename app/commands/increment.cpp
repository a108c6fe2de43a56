#include "app/commands/increment.hpp"

#include <utility>

#include <fmt/format.h>

#include "app/terminal/explain.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "talus/stream.hpp"

namespace talus::app {

Exit write_increment(const Snapshot& now, const Question& question, const std::vector<std::string>& outputs,
                     const StreamOptions& options, bool json, bool explain) {
  for (const std::string& output : outputs) {
    if (is_stream_file(output)) continue;
    throw Failure(Cause::invalid_argument,
                  fmt::format("--from asks for an increment, which has no mesh: --output {} must end in .rqt", output));
  }
  const Description& description = now.description();
  Answer answer = now.ask(question);
  Stages stages;
  if (answer.search.pages_read > 0) stages.add_search(answer.search);
  const Increment increment = increment_of(std::move(answer));
  stages.add(increment.cost);
  const Metres from = increment.from, to = increment.added.tolerance;
  const GridRect region = question.region;
  const auto write = [&] {
    // What a reader has.
    const RestrictedQuadtree base =
        now.ask({.region = region, .tolerance = from, .heights = question.heights, .threads = question.threads})
            .quadtree;
    for (const std::string& output : outputs) {
      const HoldInterrupts whole_file_or_none;
      write_stream({description, increment}, output, options, &base);
    }
  };
  if (!outputs.empty()) stages.time("write", write);
  const RestrictedQuadtree& added = increment.added;
  const std::vector<std::string> remarks =
      outputs.empty() ? std::vector<std::string>{"nothing written; add -o FILE to keep the increment"}
                      : std::vector<std::string>{};
  notes(remarks);
  if (json) {
    Json object{{"region", bounds(description, region)},
                {"from", from.value},
                {"tolerance", to.value},
                {"bound", added.bound.value},
                {"error_metric", name_of(description.error_metric)},
                {"vertices", added.vertices.size()},
                {"pages_read", increment.cost.pages_read},
                {"bytes_read", increment.cost.bytes_read},
                {"seconds", increment.cost.seconds},
                {"output", outputs},
                {"notes", remarks}};
    if (explain) object["explain"] = explained(increment.cost, stages);
    print(object);
    return Exit::done;
  }
  Table table;
  table.add("region", bounds_text(description, region));
  table.add("from", metres(from.value));
  table.add("tolerance", metres(to.value));
  table.add("bound", bound_text(description, added.bound));
  table.add("added", fmt::format("{} vertices", counted(added.vertices.size())));
  table.add("read", fmt::format("{} pages, the header's among them, {}", counted(increment.cost.pages_read),
                                sized(increment.cost.bytes_read)));
  table.add("time", timed(increment.cost.seconds));
  for (const std::string& output : outputs) table.add("output", output);
  print(table.text() + (explain ? explained_text(increment.cost, stages) : ""));
  return Exit::done;
}

}  // namespace talus::app
