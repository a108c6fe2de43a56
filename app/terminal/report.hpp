#pragma once
// What the program says: readable lines or one JSON object on standard output, nothing else there.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "talus/description.hpp"

namespace talus::app {

using Json = nlohmann::ordered_json;  // doubles shortest round trip; what is not finite becomes null

/// Two columns, the first as wide as its longest word.
class Table {
 public:
  void add(std::string_view name, std::string value) { lines_.emplace_back(name, std::move(value)); }
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
};

/// Lines of columns: the first flush left, the others right; a line of one column may be longer.
[[nodiscard]] std::string aligned(const std::vector<std::vector<std::string>>& lines);

/// Fails with io or full where standard output does.
void print(const Json& object);
void print(const Table& table);
void print(const std::string& text);

[[nodiscard]] std::string counted(std::uint64_t number);                    ///< 1234567 as 1,234,567
[[nodiscard]] std::string sized(std::uint64_t bytes);                       ///< 12.3 MB
[[nodiscard]] std::string file_size(std::uint64_t bytes, GridRect extent);  ///< 12.3 MB, 9.87 bits a sample
[[nodiscard]] std::string timed(double seconds);                            ///< 4.3 ms, 2.1 s
[[nodiscard]] std::string metres(double value);                             ///< 0.5 m, infinite
[[nodiscard]] std::string rounded(double value);                            ///< seven digits, for people

/// [xmin, ymin, xmax, ymax] of the outermost sample positions.
[[nodiscard]] Json bounds(const Description& description, GridRect region);
/// That a rectangle reaches farther than the raster.
[[nodiscard]] std::string clipped_text(const std::string& bbox);
/// What a bound is worth in a database, or in what was answered from it.
[[nodiscard]] std::string bound_text(const Description& description, Metres bound);
/// Why a bound is above the tolerance; empty where it is not.
[[nodiscard]] std::string why_coarser(const Description& description, Metres tolerance);
[[nodiscard]] std::string bounds_text(const Description& description, GridRect region);

}  // namespace talus::app
