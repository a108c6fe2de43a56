#include <cerrno>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "app/commands/commands.hpp"
#include "app/files/named_files.hpp"
#include "app/options/arguments.hpp"
#include "app/terminal/report.hpp"
#include "talus/database.hpp"

namespace talus::app {
namespace {

struct Request {
  std::string database, surface;
  std::vector<std::string> point;
  bool json = false;
};

/// Answers points, a line each.
class Answers {
 public:
  Answers(const Request& request, std::optional<Metres> tolerance)
      : json_(request.json), tolerance_(tolerance), now_(open_database(request.database).snapshot()) {}

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
    } else if (height) {
      fmt::format_to(std::back_inserter(to), "{}\n", *height);
    } else {
      fmt::format_to(std::back_inserter(to), "{}\n", why);
    }
  }

  bool json_;
  std::optional<Metres> tolerance_;
  Snapshot now_;
  std::vector<std::optional<double>> heights_;
};

/// Adds what standard input has by now, after waiting until it has something; false at its end.
bool read_more(std::string& text) {
  constexpr std::size_t kMost = std::size_t{32} << 20, kChunk = std::size_t{1} << 16;
  const std::size_t before = text.size();
  for (;;) {
    const std::size_t size = text.size();
    text.resize(size + kChunk);
    const ssize_t got = ::read(STDIN_FILENO, text.data() + size, kChunk);
    const int code = errno;
    text.resize(size + static_cast<std::size_t>(got < 0 ? 0 : got));
    if (got < 0 && code == EINTR) continue;
    if (got < 0) {
      throw Failure(Cause::io, fmt::format("cannot read standard input: {}", std::strerror(code)));
    }
    if (got == 0) return text.size() > before;
    // More points at once are cheaper each; but whoever sends one and waits gets an answer.
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
      const std::optional<Position> point = parse_position(line);
      if (!point) {
        print(answers.text(points));
        throw Failure(Cause::invalid_argument,
                      fmt::format("standard input, line {}: X and Y are expected, two numbers; \"{}\" is not that",
                                  number, line.substr(0, 100)));
      }
      points.push_back(*point);
    }
    text.erase(0, begin);
    print(answers.text(points));
    if (text.size() > kLongestPointLine) {
      throw Failure(
          Cause::invalid_argument,
          fmt::format("standard input, line {}: longer than {} bytes, so this is no point; X and Y are expected",
                      number + 1, kLongestPointLine));
    }
  }
}

Exit run(const Request& request) {
  std::optional<Metres> tolerance;
  if (!request.surface.empty()) tolerance = parse_tolerance(request.surface, "--surface");
  const bool from_input = request.point.front() == "-";
  std::optional<Position> point;
  if (!from_input && request.point.size() == 1) point = parse_position(request.point[0]);  // X,Y
  if (!point && request.point.size() != (from_input ? 1u : 2u)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("height takes X and Y, or - to read points from standard input; \"{}\" is not that",
                              fmt::join(request.point, " ")));
  }
  if (!from_input && !point) {
    point = parse_position(request.point[0] + " " + request.point[1]);
    if (!point) {
      throw Failure(Cause::invalid_argument, fmt::format("height takes X and Y, two numbers; \"{} {}\" is not that",
                                                         request.point[0], request.point[1]));
    }
  }
  Answers answers(request, tolerance);
  if (point) {
    print(answers.text({*point}));
  } else {
    answer_standard_input(answers);
  }
  return Exit::done;
}

}  // namespace

void add_height(CLI::App& program, Action& action) {
  auto request = std::make_shared<Request>();
  CLI::App* command = program.add_subcommand("height", "Heights at points");
  command->add_option("DATABASE", request->database, "Database file")->required()->check(is_named);
  command->add_option("POINT", request->point, "X and Y, or - to read points from standard input")
      ->option_text("X Y REQUIRED")
      ->required()
      ->expected(1, 2);
  command->add_option("--surface", request->surface, "Of the answer at this tolerance: metres, 0 or more, or inf")
      ->option_text("M");
  command->add_flag("--json", request->json, "Print a JSON object for each point, on a line of its own");
  command->footer(
      "\n"
      "Print the height at a point in the source's vertical unit: bilinear between the samples around it, which are\n"
      "pixel centres, or with --surface that of the mesh of the whole raster at a tolerance. The point is in the\n"
      "database's CRS, X before Y. Where there is no height the word is void, or outside.\n"
      "\n"
      "With - there is a point on each line of standard input, X and Y with blanks, a tab or a comma between, and an\n"
      "answer on each line of standard output.\n"
      "\nExample:\n"
      "  talus height alps.talus 7.6586 45.9763\n"
      "  talus height alps.talus - --surface 2 < points.txt");
  command->callback([request, &action] { action = [request] { return run(*request); }; });
}

}  // namespace talus::app
