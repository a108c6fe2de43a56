#include <cstdint>
#include <iterator>
#include <string_view>

#include <poll.h>
#include <unistd.h>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/terminal/report.hpp"
#include "app/terminal/standard_files.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database;
  std::optional<Metres> surface;
  std::vector<std::string> point;
  bool json = false;
};

/// Answers points, a line each.
class Answers {
 public:
  explicit Answers(const Request& request)
      : json_(request.json), tolerance_(request.surface), now_(open_database(request.database).snapshot()) {}

  [[nodiscard]] std::string text(const std::vector<Position>& points) {
    heights_.resize(points.size());
    now_.heights(points, heights_, tolerance_);
    fmt::memory_buffer lines;
    for (std::size_t i = 0; i < points.size(); ++i) line(points[i], heights_[i], lines);
    return fmt::to_string(lines);
  }

 private:
  void line(Position p, std::optional<double> height, fmt::memory_buffer& to) const {
    const char* why = height ? "" : is_inside(now_, p) ? "void" : "outside";
    if (json_) {
      Json object{{"x", p.x}, {"y", p.y}, {"height", nullptr}};
      height ? object["height"] = *height : object["why"] = why;
      fmt::format_to(std::back_inserter(to), "{}\n", object.dump());
    } else {
      height ? fmt::format_to(std::back_inserter(to), "{}\n", *height)
             : fmt::format_to(std::back_inserter(to), "{}\n", why);
    }
  }

  bool json_;
  std::optional<Metres> tolerance_;
  Snapshot now_;
  std::vector<std::optional<double>> heights_;
};

/// Waits for standard input, and adds what has arrived; false at the end.
bool read_more(std::string& text) {
  constexpr std::size_t kMost = std::size_t{32} << 20, kChunk = std::size_t{1} << 16;
  const std::size_t before = text.size();
  for (;;) {
    const std::size_t size = text.size();
    text.resize(size + kChunk);
    const std::size_t got = read_standard_input(std::as_writable_bytes(std::span(text).subspan(size)));
    text.resize(size + got);
    if (got == 0) return text.size() > before;
    // Many points at once are cheaper; but a program that sends one point and waits must get its answer.
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (text.size() - before > kMost || text.find('\n', size) == std::string::npos || ::poll(&input, 1, 0) != 1)
      return true;
  }
}

void answer_standard_input(Answers& answers) {
  std::string text;
  std::uint64_t number = 0;
  std::vector<Position> points;
  for (bool more = true; more;) {
    more = read_more(text);
    if (!more && !text.empty()) text += '\n';  // the last line may lack it
    points.clear();
    std::size_t begin = 0;
    for (std::size_t end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
      const std::string_view line = std::string_view(text).substr(begin, end - begin);
      ++number;
      const std::optional<Position> point = kPoint.read(line);
      if (!point) {
        print(answers.text(points));
        throw Failure(Cause::invalid_argument, fmt::format("standard input, line {}: expected {}, not \"{}\"", number,
                                                           kPoint.expected, line.substr(0, 100)));
      }
      points.push_back(*point);
    }
    text.erase(0, begin);
    print(answers.text(points));
    if (text.size() > kLongestPointLine) {
      throw Failure(Cause::invalid_argument,
                    fmt::format("standard input, line {}: expected {}; the line is longer than {} bytes", number + 1,
                                kPoint.expected, kLongestPointLine));
    }
  }
}

Exit run(Request& request) {
  const std::string words = fmt::format("{}", fmt::join(request.point, " "));
  std::optional<Position> point;
  if (words != "-") {
    point = kPoint.read(words);
    if (!point) refuse("height", "two numbers, X Y, or - for standard input", words);
  }
  Answers answers(request);
  if (point) {
    print(answers.text({*point}));
  } else {
    answer_standard_input(answers);
  }
  return Exit::done;
}

}  // namespace

void add_height(CLI::App& program, Action& action) {
  const auto request = std::make_shared<Request>();
  Command command(program, "height", "Print the height at points");
  command.database(request->database);
  command.option("X Y", request->point, "X Y", "A point, or - to read points from standard input")
      ->required()
      ->expected(1, 2);
  command.group("Most used")
      .option("--surface", request->surface, kTolerance, "M",
              "Measure on the mesh of the whole raster at this tolerance in metres, instead of "
              "between the samples");
  command.finish(
      action, request, run,
      "Without --surface the height is bilinear between the four samples around the point. It is in the vertical unit "
      "of the source. Where there is no height, the word is void or outside. talus help places explains X and Y.\n"
      "\n"
      "With - each line of standard input has X and Y, and each line of standard output has a height.\n"
      "\nExamples:\n"
      "  talus height alps.talus 7.6586 45.9763\n"
      "  talus height alps.talus - --surface 2 < points.txt",
      "Print one JSON object for each point, on its own line");
}

}  // namespace talus::app
