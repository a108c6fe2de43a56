#include "query/verify/verify_findings.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/quadtree/rect.hpp"

namespace talus {
namespace {

constexpr std::size_t kSpelledOut = 20, kMostParts = 1000;

}  // namespace

std::string name_of(PageId id) { return fmt::format("page {}/{} of band {}", id.x, id.y, id.band); }

void Findings::add(const std::string& sentence) {
  ++report_.finding_count;
  if (report_.findings.size() < kSpelledOut) report_.findings.push_back(sentence);
}

void Findings::in(PageId page, const std::string& sentence) {
  in(page_square(page), fmt::format("{}: {}", name_of(page), sentence));
}

void Findings::in(GridRect samples, const std::string& sentence) {
  const GridRect part = common(samples, description_.extent);
  if (is_empty(part)) return everywhere(sentence);
  add(sentence);
  const auto [place, is_new] = places_.try_emplace(
      std::tuple{part.first.col, part.first.row, part.last.col, part.last.row}, report_.damaged.size());
  if (!is_new) {
    ++report_.damaged[place->second].findings;
  } else if (report_.damaged.size() < kMostParts) {
    const GridMapping& m = description_.mapping;
    const Rectangle rectangle{m.x(part.first.col), m.y(part.last.row), m.x(part.last.col), m.y(part.first.row)};
    report_.damaged.push_back({part, rectangle, sentence, 1});
  } else {
    places_.erase(place);
    report_.is_rest_usable = false;  // not all findings are listed
  }
}

void Findings::everywhere(const std::string& sentence) {
  add(sentence);
  report_.is_rest_usable = false;
}

void Findings::difference(const std::string& sentence) {
  add(sentence);
  ++report_.differences;
}

}  // namespace talus
