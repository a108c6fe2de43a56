#include "app/terminal/explain.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

namespace talus::app {
namespace {

/// A row of the table; each band is a column.
struct Row {
  const char* name;
  const char* key;  ///< in JSON
  std::uint64_t (*of)(const BandCost&);
  bool is_bytes = false;
};

constexpr Row kRows[] = {
    {"in the region", "in_region", [](const BandCost& b) { return b.in_region; }},
    {"  used: an error above the tolerance", "wanted", [](const BandCost& b) { return b.wanted; }},
    {"  used: for the border or points only", "needed", [](const BandCost& b) { return b.needed; }},
    {"  skipped: a slice has the vertices", "from_slice", [](const BandCost& b) { return b.from_slice; }},
    {"  skipped: no error above the tolerance", "below_tolerance", [](const BandCost& b) { return b.below_tolerance; }},
    {"  skipped: finer than --max-level", "too_fine", [](const BandCost& b) { return b.too_fine; }},
    {"  skipped: only voids", "only_voids", [](const BandCost& b) { return b.only_voids; }},
    {"  skipped with the page above", "unasked", [](const BandCost& b) { return b.unasked(); }},
    {"beyond the region, used", "beyond", [](const BandCost& b) { return b.beyond; }},
    {"outside the region, skipped", "outside", [](const BandCost& b) { return b.outside; }},
    {"read", "pages_read", [](const BandCost& b) { return b.pages_read; }},
    {"slices read", "slices_read", [](const BandCost& b) { return b.slices_read; }},
    {"decoded before", "pages_cached", [](const BandCost& b) { return b.pages_cached; }},
    {"bytes read", "bytes_read", [](const BandCost& b) { return b.bytes_read; }, true},
};

std::string name_of(const std::vector<BandCost>& bands, std::size_t band) {
  if (band + 1 == bands.size()) return fmt::format("{} and more", bands[band].spacing);
  return fmt::format("{} to {}", bands[band].spacing, bands[band + 1].spacing / 2);
}

}  // namespace

void Stages::add(const QueryCost& cost) {
  add("read and decode", cost.reading_seconds);
  add("choose", std::max(0.0, cost.seconds - cost.reading_seconds - cost.gathering_seconds));
  add("gather", cost.gathering_seconds);
}

void Stages::add_search(const QueryCost& cost) {
  add("find the tolerance", cost.seconds);
  search_ = cost;
}

Json explained(const QueryCost& cost, const Stages& stages) {
  Json bands = Json::array(), seconds;
  for (std::size_t b = cost.bands.size(); b-- > 0;) {
    Json band{{"spacing", cost.bands[b].spacing}};
    for (const Row& row : kRows) band[row.key] = row.of(cost.bands[b]);
    bands.push_back(std::move(band));
  }
  for (const auto& [name, time] : stages.done()) seconds[name] = time;
  Json object{{"bands", bands}, {"seconds", seconds}};
  if (const QueryCost& search = stages.search(); search.pages_read > 0) {
    object["search"] = {
        {"pages_read", search.pages_read}, {"pages_cached", search.pages_cached}, {"bytes_read", search.bytes_read}};
  }
  return object;
}

std::string explained_text(const QueryCost& cost, const Stages& stages) {
  std::vector<std::vector<std::string>> lines{{"pages of spacing"}};
  for (std::size_t b = cost.bands.size(); b-- > 0;) lines.front().push_back(name_of(cost.bands, b));
  for (const Row& row : kRows) {
    const bool is_empty =
        std::all_of(cost.bands.begin(), cost.bands.end(), [&](const BandCost& band) { return row.of(band) == 0; });
    if (is_empty) continue;
    lines.push_back({row.name});
    for (std::size_t b = cost.bands.size(); b-- > 0;) {
      const std::uint64_t number = row.of(cost.bands[b]);
      lines.back().push_back(row.is_bytes ? sized(number) : counted(number));
    }
  }
  std::vector<std::vector<std::string>> times{{"time"}};
  for (const auto& [name, seconds] : stages.done()) times.push_back({"  " + name, timed(seconds)});
  std::string text = "\n" + aligned(lines) + "\n" + aligned(times);
  if (const QueryCost& search = stages.search(); search.pages_read > 0) {
    text += fmt::format("\nThe search for the tolerance read {} more pages, {}.\n", counted(search.pages_read),
                        sized(search.bytes_read));
  }
  return text;
}

}  // namespace talus::app
