// The talus command: each subcommand is one call of the public API plus printing.

#include <algorithm>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/options/arguments.hpp"
#include "app/terminal/fields.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "app/terminal/standard_files.hpp"
#include "talus/failure.hpp"

namespace talus::app {
namespace {

Exit exit_for(Cause cause) {
  switch (cause) {
    case Cause::invalid_argument: return Exit::usage;
    case Cause::corrupt: return Exit::corrupt;
    case Cause::full: return Exit::full;
    case Cause::not_found:
    case Cause::unsupported:
    case Cause::io:
    case Cause::cancelled:
    case Cause::too_large:
    case Cause::out_of_memory: return Exit::failed;
  }
  return Exit::failed;
}

/// What went wrong.
struct Complaint {
  std::string cause, sentence;
  Exit code = Exit::failed;
  std::string file = {};  ///< at fault; empty: none
};

std::string word_for(Cause cause) {
  switch (cause) {
    case Cause::invalid_argument: return "invalid_argument";
    case Cause::not_found: return "not_found";
    case Cause::corrupt: return "corrupt";
    case Cause::unsupported: return "unsupported";
    case Cause::full: return "full";
    case Cause::io: return "io";
    case Cause::cancelled: return "cancelled";
    case Cause::too_large: return "too_large";
    case Cause::out_of_memory: return "out_of_memory";
  }
  return "unknown";
}

/// A sentence on standard error; where programs listen, one JSON object on a line of standard output, too.
Exit complain(const Complaint& complaint, bool json) {
  say(complaint.sentence);
  if (!json) return complaint.code;
  const Json failure{{"cause", complaint.cause},
                     {"exit_code", static_cast<int>(complaint.code)},
                     {"file", complaint.file.empty() ? Json() : Json(complaint.file)},
                     {"message", with_options(complaint.sentence)}};
  try {
    print(Json{{"failure", failure}}.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
  } catch (const Failure&) {  // the sentence has been said, and the exit code stays what it was about
  }
  return complaint.code;
}

Complaint misused(std::string sentence) {
  return {word_for(Cause::invalid_argument), std::move(sentence), Exit::usage};
}

Exit run(std::vector<std::string> arguments, bool json) {
  CLI::App program{
      "Terrain with a true error bound: takes in an elevation raster, answers any rectangle at any\n"
      "tolerance with a crack-free mesh no covered sample of which is farther away than asked.\n",
      "talus"};
  program.set_version_flag("--version", "talus " TALUS_VERSION, "Print the version and exit");
  program.set_help_flag("-h,--help", "Print this help and exit; talus SUBCOMMAND --help says more");
  program.require_subcommand(1);
  program.footer(
      "\nExample:\n"
      "  talus ingest alps.tif alps.talus\n"
      "  talus query alps.talus --tolerance 2 --bbox=7.5,45.9,7.8,46.1 -o matterhorn.ply\n"
      "\nExit codes: 0 done, 1 failed (not found, I/O, unsupported), 2 usage or invalid argument, 3 damaged or\n"
      "not a database, 4 disk full, 5 differs from its source or lies beyond its bound, 130 interrupted.");
  Action action;
  add_ingest(program, action);
  add_compact(program, action);
  add_info(program, action);
  add_query(program, action);
  add_height(program, action);
  add_profile(program, action);
  add_merge(program, action);
  add_convert(program, action);
  add_accuracy(program, action);
  add_verify(program, action);

  const std::string first = arguments.empty() ? "" : arguments.front();
  try {
    arguments = join_numbers(std::move(arguments));
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
    program.parse(arguments);
  } catch (const CLI::Success& wanted) {  // help and version
    std::ostringstream text;
    program.exit(wanted, text, text);
    print(text.str());
    return Exit::done;
  } catch (const CLI::ParseError& error) {
    if (program.get_subcommands().empty() && !first.empty() && first[0] != '-') {
      return complain(misused(fmt::format(
                          "there is no subcommand {}; there are ingest, compact, info, query, height, profile, merge, "
                          "convert, accuracy and verify",
                          first)),
                      json);
    }
    return complain(misused(fmt::format("{} (talus --help says more)", error.what())), json);
  }
  return action();
}

Exit guarded(int argc, char** argv) {
  const std::vector<std::string> arguments{argv + std::min(argc, 1), argv + argc};
  const bool json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  try {
    return run(arguments, json);
  } catch (const Failure& failure) {
    return complain({word_for(failure.cause()), failure.what(), exit_for(failure.cause()), failure.file().string()},
                    json);
  } catch (const Interrupted& interrupt) {
    return complain({"interrupted", interrupt.sentence, Exit::interrupted}, json);
  } catch (const std::bad_alloc&) {
    return complain({"out_of_memory", "out of memory", Exit::failed}, json);
  } catch (const std::exception& error) {
    return complain({"unexpected", fmt::format("unexpected, please report: {}", error.what()), Exit::failed}, json);
  }
}

}  // namespace
}  // namespace talus::app

int main(int argc, char** argv) {
  talus::app::secure_standard_files();
  talus::app::exit_when_interrupted();
  return static_cast<int>(talus::app::guarded(argc, argv));
}
