// The talus command: each subcommand is one call of the public API plus printing.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/fields.hpp"
#include "app/interrupt.hpp"
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
    case Cause::io: return Exit::failed;
  }
  return Exit::failed;
}

// One line, whatever a file name holds.
Exit complain(std::string sentence, Exit code) {
  sentence = with_options(std::move(sentence));
  std::replace_if(
      sentence.begin(), sentence.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  fmt::print(stderr, "talus: {}\n", sentence);
  return code;
}

Exit run(std::vector<std::string> arguments) {
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
    program.exit(wanted);
    return std::fflush(stdout) == 0 ? Exit::done : complain("cannot write to standard output", Exit::failed);
  } catch (const CLI::ParseError& error) {
    if (program.get_subcommands().empty() && !first.empty() && first[0] != '-') {
      return complain(fmt::format("there is no subcommand {}; there are ingest, compact, info, query, height, profile, merge, "
                                  "convert, accuracy and verify",
                                  first),
                      Exit::usage);
    }
    return complain(fmt::format("{} (talus --help says more)", error.what()), Exit::usage);
  }
  return action();
}

Exit guarded(int argc, char** argv) {
  try {
    return run({argv + std::min(argc, 1), argv + argc});
  } catch (const Failure& failure) {
    return complain(failure.what(), exit_for(failure.cause()));
  } catch (const Interrupted&) {
    return Exit::interrupted;
  } catch (const std::bad_alloc&) {
    return complain("out of memory", Exit::failed);
  } catch (const std::exception& error) {
    return complain(fmt::format("unexpected, please report: {}", error.what()), Exit::failed);
  }
}

}  // namespace
}  // namespace talus::app

int main(int argc, char** argv) {
  talus::app::exit_when_interrupted();
  return static_cast<int>(talus::app::guarded(argc, argv));
}
