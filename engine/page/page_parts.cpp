#include "engine/page/page_parts.hpp"

#include <cstring>

namespace talus {

void ErrorsOfHeights::imply(ErrorForm form, const std::vector<std::int32_t>& narrow, Page& page) {
  const Placement place(page.grid);
  page.eighths.clear();
  page.distances.clear();
  if (form == ErrorForm::none) return;
  std::span<const std::uint8_t> data;
  if (!page.valid.empty()) {
    valid.assign(kSquare, 0);
    place.into_square(page.valid, valid);
    data = valid;
  }
  if (form == ErrorForm::whole) {
    eighths.resize(kSquare);
    if (!whole) whole.emplace();
    whole->compute(narrow, place.present(), data, eighths);
    place.from_square(eighths, page.eighths);
    return;
  }
  square.assign(kSquare, 0);
  place.into_square(page.heights, square);
  distances.resize(kSquare);
  if (form == ErrorForm::exact) {
    if (!exact) exact.emplace();
    exact->compute(square, place.present(), data, distances);
  } else {
    implied_errors_rounded_up(square, place.present(), data, distances);
  }
  place.from_square(distances, page.distances);
}

CodesOfEighths EighthsAsCodes::in(const CodeDistance& distance) {
  if (distance.is_whole()) return nullptr;
  if (codes_ == nullptr || !(distance == distance_)) {
    const auto made = std::make_unique<std::array<ErrorCode, 1 << 15>>();
    ErrorCode code = 0;
    for (std::size_t i = 0; i < made->size(); ++i) {
      const double metres = distance.metres(static_cast<double>(i) / 8);
      while (error_of(code) < metres) ++code;
      (*made)[i] = code;
    }
    codes_ = std::make_unique<const std::array<ErrorCode, 1 << 15>>(*made);
    distance_ = distance;
  }
  return codes_.get();
}

void PageWorkspace::mark_needed(const Page& of) {
  needed.clear();
  if (of.valid.empty()) return;
  needed.assign(of.grid.size(), 1);
  for (std::size_t i = 0; i < of.valid.size(); ++i)
    needed[i] = of.valid[i] != 0 || (!of.covers.empty() && of.covers[i] != 0) ? 1 : 0;
}

const SquareBits* PageWorkspace::stored_samples() {
  if (needed.empty() && page.grid.size() == kSquare) return nullptr;
  stored_bits = needed.empty() ? present_samples(page.grid) : marked_samples(page.grid, needed);
  return &stored_bits;
}

void PageWorkspace::copy_whole(unsigned width) {
  whole_square.resize(kSquare);
  if (width == 2) {
    std::transform(narrow_square.begin(), narrow_square.end(), whole_square.begin(),
                   [](std::uint16_t v) { return std::int32_t{static_cast<std::int16_t>(v)}; });
  } else {
    std::transform(wide_square.begin(), wide_square.end(), whole_square.begin(),
                   [](std::uint32_t v) { return static_cast<std::int32_t>(v); });
  }
}

}  // namespace talus
