#pragma once
// Standard output: lines for people, or one JSON object.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "talus/cost.hpp"
#include "talus/description.hpp"

namespace talus::app {

using Json = nlohmann::ordered_json;  // doubles have all digits; infinity and NaN become null

/// Two columns, the first as wide as its longest word.
class Table {
 public:
  void add(std::string_view name, std::string value) { lines_.emplace_back(name, std::move(value)); }
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
};

/// Lines of columns: the first on the left, the others on the right. A line of one column may be longer.
[[nodiscard]] std::string aligned(const std::vector<std::vector<std::string>>& lines);

/// fails  io, full: standard output cannot be written
void print(const Json& object);
void print(const Table& table);
void print(const std::string& text);

[[nodiscard]] std::string counted(std::uint64_t number);                    ///< 1234567 as 1,234,567
[[nodiscard]] std::string sized(std::uint64_t bytes);                       ///< 12.3 MB
[[nodiscard]] std::string file_size(std::uint64_t bytes, GridRect extent);  ///< 12.3 MB, 9.87 bits a sample
[[nodiscard]] std::string timed(double seconds);                            ///< 4.3 ms, 2.1 s
[[nodiscard]] std::string metres(double value);                             ///< 0.5 m, infinite
[[nodiscard]] std::string rounded(double value);                            ///< seven digits, for people
[[nodiscard]] std::string quoted(const std::string& word);                  ///< 'with blank.tif', as a shell reads it

/// [xmin, ymin, xmax, ymax] of the outermost samples.
[[nodiscard]] Json bounds(const Description& description, GridRect region);
[[nodiscard]] std::string bounds_text(const Description& description, GridRect region);
/// A note that the raster is smaller than a rectangle.
[[nodiscard]] std::string clipped_text(const Rectangle& asked);
/// Adds "asked" and "clipped".
void add_rectangle(Json& object, const Rectangle& asked, bool is_clipped);

/// A bound, and what it means in this database.
[[nodiscard]] std::string bound_text(const Description& description, Metres bound);
/// What heights are multiples of; 0: they are exact.
[[nodiscard]] std::string heights_text(Metres quantum);
/// Why a bound is above the tolerance; empty where it is not.
[[nodiscard]] std::string why_coarser(const Description& description, Metres tolerance);
void add_bound(Json& object, const Description& description, Metres tolerance, Metres bound);
void add_bound(Table& table, const Description& description, Metres tolerance, Metres bound);
[[nodiscard]] std::string mesh_text(std::uint64_t vertices, std::uint64_t triangles);
void add_cost(Json& object, const QueryCost& cost, double seconds);
void add_cost(Table& table, const QueryCost& cost, double seconds);

}  // namespace talus::app
