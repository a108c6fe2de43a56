#pragma once
// Words of the command line that mean something to us.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "talus/description.hpp"
#include "talus/ingest.hpp"
#include "talus/question.hpp"
#include "talus/units.hpp"

namespace talus::app {

/// Metres from 0 to "inf". Fails with invalid_argument, naming option and value.
[[nodiscard]] Metres parse_tolerance(const std::string& word, const char* option = "--tolerance");
/// "1,5,20": metres, 0 or more, finite; at least one.
[[nodiscard]] std::vector<Metres> parse_tolerances(const std::string& word, const char* option = "--tolerances");
/// "10ms", "0.5s": seconds, more than 0, finite.
[[nodiscard]] double parse_time(const std::string& word);
/// "XMIN,YMIN,XMAX,YMAX", four finite numbers; which is larger is the query's business.
[[nodiscard]] Rectangle parse_bbox(const std::string& word);
/// "X,Y,X,Y" and so on, two points or more, finite numbers.
[[nodiscard]] std::vector<Position> parse_line(const std::string& word);
/// "X Y", "X,Y", or with tabs: two finite numbers and nothing else.
[[nodiscard]] std::optional<Position> parse_position(std::string_view text);
/// Bytes of a line with a point.
inline constexpr std::size_t kLongestPointLine = 4096;
/// Points of one file.
inline constexpr std::size_t kMostPoints = 10'000'000;

/// A number of at least 0, finite.
[[nodiscard]] double parse_weight(const std::string& word);

/// "512MiB", "2GB", "1e9": bytes, at least one.
[[nodiscard]] std::uint64_t parse_bytes(const std::string& word);
/// "DX,DY" or one number for both, larger than 0.
[[nodiscard]] std::pair<double, double> parse_cell(const std::string& word);
/// Metres, larger than 0.
[[nodiscard]] Metres parse_height_step(const std::string& word);
/// A finite number or nan.
[[nodiscard]] double parse_nodata(const std::string& word);
/// "none", "terrain-rgb" or "terrarium".
[[nodiscard]] ColourCode parse_decode(const std::string& word);
/// "later" (false) or "resolution" (true).
[[nodiscard]] bool parse_priority(const std::string& word);
/// "vertical" or "perpendicular".
[[nodiscard]] ErrorMetric parse_error_metric(const std::string& word);

/// "constrain", "cover" or "clip".
[[nodiscard]] Border parse_border(const std::string& word);
struct Focus {
  double x, y, metres_per_metre;
};
/// "X,Y,METRES_PER_METRE", the last at least 0.
[[nodiscard]] Focus parse_focus(const std::string& word);

/// What a word lacks to name a file; empty where it lacks nothing, as CLI11 wants it of a check.
[[nodiscard]] std::string is_named(const std::string& word);

/// Spells a count as digits: "1e5", "100k", "2.5M" (of thousands). Returns what is wrong, or nothing, as CLI11 wants it
/// of a transformation.
[[nodiscard]] std::string whole_number(std::string& word);
[[nodiscard]] inline CLI::Validator whole() { return {whole_number, ""}; }

/// The arguments with "--bbox -1,2,3,4" and "--bbox -1 2 3 4" made one word, "--bbox=-1,2,3,4", and -.5 written -0.5: a
/// number is no option.
[[nodiscard]] std::vector<std::string> join_numbers(std::vector<std::string> arguments);

}  // namespace talus::app
