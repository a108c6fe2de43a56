#pragma once
// A subcommand as it is put together. Options of many commands (DATABASE, --bbox, --threads, --json) are methods here;
// app/options/arguments reads the values.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/options/arguments.hpp"
#include "app/terminal/exit.hpp"

namespace talus::app {

/// What is done once the command line has been read.
using Action = std::function<Exit()>;

/// The options of a subcommand. An option belongs to the group named last; help shows the groups in this order.
///
/// names  "-o,--output"
/// value  stays alive as long as the program
/// word   stands for the value in help: "M"
class Command {
 public:
  Command(CLI::App& program, const char* name, const char* summary) : app_(*program.add_subcommand(name, summary)) {}

  Command& group(const char* heading) {
    group_ = heading;
    return *this;
  }
  CLI::Option* flag(const char* names, bool& value, const char* text) {
    return app_.add_flag(names, value, text)->group(group_);
  }
  template <class T>
  CLI::Option* option(const char* names, T& value, const char* word, const char* text) {
    return shown(app_.add_option(names, value, text), word);
  }
  /// A word that is read at once.
  template <class T, class Value>
  CLI::Option* option(const char* names, T& value, const Kind<Value>& kind, const char* word, const char* text) {
    return function(names, word, text, [=, &value](const std::string& typed) { value = read(kind, names, typed); });
  }
  /// The same, repeated: each is added to the values.
  template <class T>
  void options(const char* names, std::vector<T>& values, const Kind<T>& kind, const char* word, const char* text) {
    const auto add = [=, &values](const std::vector<std::string>& all) {
      for (const std::string& typed : all) values.push_back(read(kind, names, typed));
      return true;
    };
    repeated(shown(app_.add_option_function<std::vector<std::string>>(names, add, text), word));
  }
  /// A whole number; 1e5 and 100k are, too.
  template <class T>
  CLI::Option* number(const char* names, T& value, const char* word, const char* text, std::int64_t least,
                      std::int64_t most = std::numeric_limits<std::int32_t>::max()) {
    return function(names, word, text, [=, &value](const std::string& typed) {
      value = static_cast<typename decltype(std::optional(value))::value_type>(read_whole(names, typed, least, most));
    });
  }
  /// One of several names; the first is the one that holds without the option.
  template <class T, class Value>
  CLI::Option* choice(const char* names, Value& value, Names<T> choices, const char* text) {
    return function(names, "WORD", text,
                    [=, &value](const std::string& typed) { value = named(choices, names, typed); });
  }
  /// A file; the name must not be empty.
  template <class T>
  CLI::Option* file(const char* names, T& value, const char* word, const char* text) {
    return option(names, value, word, text)->check(is_named);
  }
  template <class T>
  CLI::Option* files(const char* names, std::vector<T>& values, const char* word, const char* text) {
    return repeated(file(names, values, word, text));
  }

  void database(std::string& value, const char* text = "Database file") {
    group("Arguments").file("DATABASE", value, "DATABASE", text)->required();
  }
  void bbox(std::optional<Rectangle>& value, const char* text) {
    option("--bbox", value, kBox, "XMIN,YMIN,XMAX,YMAX", text);
  }
  void threads(int& value) {
    number("--threads", value, "N", "Use N threads. The result is the same. 0, the default: one for each core", 0,
           1024);
  }

  /// Ends the list. `about` is the text below the options; lines that begin with "  talus" are examples.
  template <class Request>
  void finish(Action& action, std::shared_ptr<Request> request, Exit (*work)(Request&), const std::string& about,
              const char* json = "Print one JSON object") {
    group("Other");
    if constexpr (requires { request->json; }) flag("--json", request->json, json);
    app_.set_help_flag("-h,--help", "Print this help")->group(group_);
    app_.footer(about);
    app_.callback([=, &action] { action = [=] { return work(*request); }; });
  }

 private:
  CLI::Option* shown(CLI::Option* option, const char* word) { return option->option_text(word)->group(group_); }
  CLI::Option* function(const char* names, const char* word, const char* text,
                        const std::function<void(const std::string&)>& work) {
    return shown(app_.add_option_function<std::string>(names, work, text), word);
  }
  static CLI::Option* repeated(CLI::Option* option) {
    return option->type_size(1)->expected(1)->allow_extra_args(false)->multi_option_policy(
        CLI::MultiOptionPolicy::TakeAll);
  }

  CLI::App& app_;
  std::string group_ = "Options";
};

}  // namespace talus::app
