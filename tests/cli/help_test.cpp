// Help: its width, its topics, and the names it suggests for mistyped ones.

#include <cstdlib>
#include <regex>
#include <sstream>

#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// COLUMNS as long as it lives.
class Columns {
 public:
  explicit Columns(int width) { ::setenv("COLUMNS", std::to_string(width).c_str(), 1); }
  ~Columns() { ::unsetenv("COLUMNS"); }
  Columns(const Columns&) = delete;
  Columns& operator=(const Columns&) = delete;
};

class HelpPages : public Command {
 protected:
  void SetUp() override { ::unsetenv("COLUMNS"); }

  [[nodiscard]] std::string page(const std::vector<std::string>& arguments) const {
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, done) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  }
  /// The words that the program lists below a heading.
  [[nodiscard]] std::vector<std::string> listed(const std::string& heading) const {
    std::istringstream lines(page({"--help"}));
    std::vector<std::string> words;
    bool is_below = false;
    for (std::string line; std::getline(lines, line);) {
      if (line == heading) is_below = true;
      if (is_below && line.empty()) break;
      if (is_below && line.starts_with("  ") && line[2] != ' ') words.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    EXPECT_GT(words.size(), 5u);
    return words;
  }
  [[nodiscard]] std::vector<std::string> commands() const { return listed("Subcommands:"); }
  [[nodiscard]] std::vector<std::string> topics() const { return listed("Topics:"); }

  std::string refusal(const std::vector<std::string>& arguments) const {
    auto with_json = arguments;
    with_json.push_back("--json");
    const auto failure = json_of(talus(with_json))["failure"];
    EXPECT_EQ(failure["cause"], "invalid_argument");
    EXPECT_EQ(failure["exit_code"], usage);
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, usage);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, "talus: " + failure["message"].get<std::string>() + "\n");
    return outcome.err;
  }
};

// ---- width ---------------------------------------------------------------------------------------------------

/// A line may be longer only if it is one word: an option and its value, or a word and a backslash, count as one.
void expect_width(const std::string& page, std::size_t width) {
  static const std::regex one_word(R"( *(-\S+ )?\S+( \\)?)");
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_TRUE(line.size() <= width || std::regex_match(line, one_word)) << width << ": " << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
}

TEST_F(HelpPages, AreAsWideAsTheTerminalAndNoWider) {
  std::vector<std::vector<std::string>> all{{"--help"}};
  for (const auto& names : {commands(), topics()}) {
    for (const std::string& name : names) all.push_back({"help", name});
  }
  for (const int width : {40, 80, 120}) {
    const Columns columns(width);
    for (const auto& arguments : all) expect_width(page(arguments), static_cast<std::size_t>(width));
  }
}

TEST_F(HelpPages, HaveOneTextAtEachWidth) {
  const auto words = [&](int width, const std::vector<std::string>& arguments) {
    const Columns columns(width);
    return std::regex_replace(page(arguments), std::regex(R"(( \\)?\s+)"), " ");
  };
  for (const char* word : {"query", "ingest", "outputs", "tolerance"})
    EXPECT_EQ(words(40, {"help", word}), words(120, {"help", word})) << word;
}

TEST_F(HelpPages, StayBetween40And120LettersAndAre80WithoutATerminal) {
  const std::string usual = page({"query", "--help"});
  const auto at = [&](int width) {
    const Columns columns(width);
    return page({"query", "--help"});
  };
  EXPECT_EQ(usual, at(80));
  EXPECT_EQ(at(10), at(40));
  EXPECT_EQ(at(500), at(120));
  EXPECT_EQ(usual, at(0));
  EXPECT_NE(at(40), at(80));
}

TEST_F(HelpPages, FollowTheWindowOfATerminal) {
  winsize window{};
  window.ws_col = 50;
  window.ws_row = 24;
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &window);
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::execl(TALUS_PROGRAM, "talus", "help", "places", nullptr);
    ::_exit(127);
  }
  std::string shown;
  char room[4096];
  for (ssize_t got = 0; (got = ::read(terminal, room, sizeof room)) > 0;) shown.append(room, static_cast<size_t>(got));
  ::close(terminal);
  int status = 0;
  ::waitpid(child, &status, 0);
  std::erase(shown, '\r');
  const Columns columns(50);
  EXPECT_EQ(shown, page({"help", "places"}));
}

// ---- pages ---------------------------------------------------------------------------------------------------

TEST_F(HelpPages, OfASubcommandAreItsHelp) {
  EXPECT_EQ(page({"help"}), page({"--help"}));
  for (const std::string& command : commands()) {
    EXPECT_EQ(page({"help", command}), page({command, "--help"})) << command;
    EXPECT_THAT(page({"help", command}), HasSubstr("Usage: talus " + command));
  }
}

TEST_F(HelpPages, BeginWithAtMostThreeOptionsThatPeopleUseMost) {
  for (const char* command : {"ingest", "query", "height", "profile", "merge", "convert", "accuracy", "verify"}) {
    const std::string text = page({"help", command});
    const std::size_t begin = text.find("\nMost used:\n");
    ASSERT_NE(begin, std::string::npos) << command;
    EXPECT_EQ(text.find("\n  -"), begin + 11) << "no option comes before";
    const std::string group = text.substr(begin, text.find("\n\n", begin) - begin);
    const std::regex option("\n  -");
    const auto count = std::distance(std::sregex_iterator(group.begin(), group.end(), option), std::sregex_iterator());
    EXPECT_GE(count, 1) << command;
    EXPECT_LE(count, 3) << command;
  }
}

TEST_F(HelpPages, OfATopicHaveFiveToThirtyLines) {
  for (const std::string& topic : topics()) {
    const std::string text = page({"help", topic});
    const auto lines = std::count(text.begin(), text.end(), '\n');
    EXPECT_GE(lines, 5) << topic;
    EXPECT_LE(lines, 30) << topic;
  }
  const std::string sentence = refusal({"help", "weather"});
  for (const std::string& topic : topics()) EXPECT_THAT(sentence, HasSubstr(topic));
}

TEST_F(HelpPages, NameNoFieldOfTheLibrary) {
  for (const auto& names : {commands(), topics()}) {
    for (const std::string& name : names) EXPECT_THAT(page({"help", name}), Not(HasSubstr("::"))) << name;
  }
}

// ---- mistyped names ------------------------------------------------------------------------------------------

TEST_F(HelpPages, AMistypedNameIsAnsweredWithTheNearestOne) {
  make_database("a.talus");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"qurey", "a.talus"}, "query"},
      {{"igest", "a.tif", "a.talus"}, "ingest"},
      {{"acc", "a.talus"}, "accuracy"},
      {{"query", "a.talus", "--tolerence", "2"}, "--tolerance"},
      {{"query", "a.talus", "--tolerence=2"}, "--tolerance"},
      {{"query", "a.talus", "--tolerance=2", "--bbx", "1", "2", "3", "4"}, "--bbox"},
      {{"query", "--max-tri", "100"}, "--max-triangles"},
      {{"profile", "a.talus", "--tolerance=2", "--lin=1,2,3,4"}, "--line"},
      {{"query", "a.talus", "--tolerance=2", "--border", "clp"}, "clip"},
      {{"query", "a.talus", "--tolerance=2", "--heights", "fited"}, "fitted"},
      {{"ingest", "a.tif", "b.talus", "--metric", "perpendiclar"}, "perpendicular"},
      {{"ingest", "a.tif", "b.talus", "--decode", "terarium"}, "terrarium"},
      {{"ingest", "a.tif", "b.talus", "--priority", "resolutoin"}, "resolution"},
      {{"ingest", "a.tif", "b.talus", "--resampling", "cubci"}, "cubic"},
      {{"ingest", "a.tif", "b.talus", "--progress", "jsno"}, "json"},
      {{"help", "tolerence"}, "tolerance"},
      {{"help", "qury"}, "query"},
  };
  for (const auto& [arguments, meant] : cases)
    EXPECT_THAT(refusal(arguments), HasSubstr("did you mean " + meant + "?")) << ::testing::PrintToString(arguments);
}

TEST_F(HelpPages, ANameFarFromAllOthersIsAnsweredWithoutAGuess) {
  make_database("a.talus");
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"nonsense"},
           {"x"},
           {"query", "a.talus", "--tolerance=2", "--nonsense"},
           {"query", "a.talus", "--tolerance=2", "-q"},
           {"query", "a.talus", "--tolerance=2", "--border", "nonsense"},
           {"help", "nonsense"},
       })
    EXPECT_THAT(refusal(arguments), Not(HasSubstr("did you mean"))) << ::testing::PrintToString(arguments);
  EXPECT_THAT(refusal({"query", "a.talus", "--tolerance=2", "--border", "nonsense"}),
              HasSubstr("constrain, cover or clip"));
}

// ---- fields of the library -----------------------------------------------------------------------------------

TEST_F(HelpPages, EveryFieldThatASentenceOfTheLibraryNamesHasAnOption) {
  const std::filesystem::path source = TALUS_SOURCE_DIR;
  const std::string table = bytes_of(source / "app/terminal/fields.cpp");
  const std::regex literal(R"("(?:[^"\\\n]|\\.)*")"), field(R"(\b(\w+Options|Question|Heights)::[a-z]\w+)");
  int found = 0;
  for (const char* room : {"engine", "storage", "ingest", "query"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / room)) {
      if (!entry.is_regular_file()) continue;
      const std::string text = bytes_of(entry.path());
      for (std::sregex_iterator l(text.begin(), text.end(), literal), end; l != end; ++l) {
        const std::string words = l->str();
        for (std::sregex_iterator f(words.begin(), words.end(), field); f != end; ++f) {
          if (f->str() == "Question::stop") continue;  // no command line sets it
          EXPECT_THAT(table, HasSubstr('"' + f->str() + '"')) << entry.path();
          ++found;
        }
      }
    }
  }
  EXPECT_GT(found, 50);
}

}  // namespace
}  // namespace talus::support
