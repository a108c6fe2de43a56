// The talus command: each subcommand is one call of the public API plus printing.

#include <algorithm>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/terminal/fields.hpp"
#include "app/terminal/help.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/say.hpp"
#include "app/terminal/standard_files.hpp"
#include "talus/failure.hpp"

namespace talus::app {
namespace {

/// Something that went wrong.
struct Complaint {
  std::string cause, sentence;
  Exit code = Exit::failed;
  std::string file = {};  ///< the file at fault; empty: none
};

/// The word in JSON, and the exit code.
std::pair<const char*, Exit> word_and_code(Cause cause) {
  switch (cause) {
    case Cause::invalid_argument: return {"invalid_argument", Exit::usage};
    case Cause::not_found: return {"not_found", Exit::failed};
    case Cause::corrupt: return {"corrupt", Exit::corrupt};
    case Cause::unsupported: return {"unsupported", Exit::failed};
    case Cause::full: return {"full", Exit::full};
    case Cause::io: return {"io", Exit::failed};
    case Cause::cancelled: return {"cancelled", Exit::failed};
    case Cause::too_large: return {"too_large", Exit::failed};
    case Cause::out_of_memory: return {"out_of_memory", Exit::failed};
  }
  return {"unknown", Exit::failed};
}

/// Prints the sentence on standard error; with --json, also a line of JSON on standard output.
Exit complain(const Complaint& complaint, bool json) {
  say(complaint.sentence);
  if (!json) return complaint.code;
  const Json failure{{"cause", complaint.cause},
                     {"exit_code", static_cast<int>(complaint.code)},
                     {"file", complaint.file.empty() ? Json() : Json(complaint.file)},
                     {"message", with_options(complaint.sentence)}};
  try {
    print(Json{{"failure", failure}}.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
  } catch (const Failure&) {  // the sentence has been said, and the exit code is that of the first failure
  }
  return complaint.code;
}

/// CLI11's sentences about too few or too many values, in plain words.
std::string plain(std::string sentence) {
  const std::pair<const char*, const char*> kWords[] = {{": 1 required TEXT missing", " needs a value"},
                                                        {" is required", " is missing"},
                                                        {": At Least ", " needs at least "},
                                                        {": At least ", " needs at least "},
                                                        {": At Most ", " takes at most "},
                                                        {": At most ", " takes at most "},
                                                        {" required but received ", ", given: "}};
  for (const auto& [from, to] : kWords) {
    const std::size_t at = sentence.find(from);
    if (at != std::string::npos) sentence.replace(at, std::string_view(from).size(), to);
  }
  return sentence;
}

/// What is wrong with a command line that CLI11 refuses.
std::string misuse(const CLI::App& program, const std::string& first, const CLI::ParseError& error) {
  const auto chosen = program.get_subcommands();
  std::vector<std::string> names;
  if (chosen.empty() && !first.empty() && first[0] != '-') {
    for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
    const std::string meant = did_you_mean(first, names);
    return fmt::format("there is no command {}{}", first, meant.empty() ? "; choose " + listed(names, "or") : meant);
  }
  const CLI::App& command = chosen.empty() ? program : *chosen.front();
  const std::string help = chosen.empty() ? "talus --help" : "talus help " + command.get_name();
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const std::string& word : command.remaining()) {
    if (!word.starts_with('-') || word.size() < 2) continue;
    const std::string name = word.substr(0, word.find('='));
    const std::string meant = did_you_mean(name, names);
    return fmt::format("there is no option {}{}", name, meant.empty() ? "; " + help + " lists them" : meant);
  }
  if (chosen.empty()) return "a command is missing; " + help + " lists them";
  const std::vector<std::string> extra = command.remaining();
  return fmt::format("{}; {} says more", extra.empty() ? plain(error.what()) : "unexpected word " + extra.front(),
                     help);
}

Exit run(std::vector<std::string> arguments) {
  CLI::App program{
      "Talus answers questions about terrain. Ask for a rectangle and a tolerance in metres: the mesh has no cracks, "
      "and every sample under it lies within the tolerance.",
      "talus"};
  program.formatter(std::make_shared<Help>());
  program.set_version_flag("--version", "talus " TALUS_VERSION, "Print the version");
  program.set_help_flag("-h,--help", "Print this help");
  program.require_subcommand(1);
  program.footer("talus help COMMAND explains a command, talus help TOPIC a topic.\n\n" + topics() +
                 "\n\nExamples:\n"
                 "  talus ingest alps.tif alps.talus\n"
                 "  talus query alps.talus --tolerance 2 --bbox=7.5,45.9,7.8,46.1 -o matterhorn.ply");
  Action action;
  for (const auto add : {add_ingest, add_query, add_height, add_profile, add_info, add_merge, add_convert, add_accuracy,
                         add_verify, add_compact, add_help})
    add(program, action);

  const std::string first = arguments.empty() ? "" : arguments.front();
  try {
    arguments = join_numbers(std::move(arguments));
    std::reverse(arguments.begin(), arguments.end());  // CLI11 reads them from the back
    program.parse(arguments);
  } catch (const CLI::Success& wanted) {  // help and version
    std::ostringstream text;
    program.exit(wanted, text, text);
    print(text.str());
    return Exit::done;
  } catch (const CLI::ParseError& error) {
    throw Failure(Cause::invalid_argument, misuse(program, first, error));
  }
  return action();
}

Exit guarded(int argc, char** argv) {
  const std::vector<std::string> arguments{argv + std::min(argc, 1), argv + argc};
  const bool json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  try {
    return run(arguments);
  } catch (const Failure& failure) {
    const auto [cause, code] = word_and_code(failure.cause());
    return complain({cause, failure.what(), code, failure.file().string()}, json);
  } catch (const Interrupted& interrupt) {
    return complain({"interrupted", interrupt.sentence, Exit::interrupted}, json);
  } catch (const std::bad_alloc&) {
    return complain({"out_of_memory", "out of memory", Exit::failed}, json);
  } catch (const std::exception& error) {
    return complain({"unexpected", fmt::format("unexpected: {}; please report it", error.what()), Exit::failed}, json);
  }
}

}  // namespace
}  // namespace talus::app

int main(int argc, char** argv) {
  talus::app::secure_standard_files();
  talus::app::exit_when_interrupted();
  return static_cast<int>(talus::app::guarded(argc, argv));
}
