#include "query/pages/kept_heights.hpp"

namespace talus {

const Page* KeptHeights::page_with(GridPoint p) {
  const int bands = pages_.manifest().bands;
  const PageId id = page_of(p, band_of(p, bands));
  if (bands_.empty()) bands_.resize(static_cast<std::size_t>(bands));
  Band& band = bands_[static_cast<std::size_t>(id.band)];
  if (band.page == nullptr || band.id != id) {
    band.page = nullptr;
    if (!pages_.transaction().has({id.band, curve_position(id)})) return nullptr;
    band.page = &pages_.get(id, 0, band.decoder, cost_);  // 0: updates need all samples, so there are none
    band.id = id;
  }
  return band.page;
}

double KeptHeights::at(GridPoint p) {
  const Page* page = page_with(p);
  if (page == nullptr) return 0;
  const std::size_t i = page->index(p);
  if (is_kept(*page, i, p)) return page->height(i);
  const std::uint64_t key = std::uint64_t{static_cast<std::uint32_t>(p.col)} << 32 | static_cast<std::uint32_t>(p.row);
  if (const auto known = found_.find(key); known != found_.end()) return known->second;
  const Diamond d = diamond(p);
  const double height = at(d.ends[0]) / 2 + at(d.ends[1]) / 2;
  found_.emplace(key, height);
  return height;
}

}  // namespace talus
