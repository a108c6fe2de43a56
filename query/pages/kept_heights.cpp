#include "query/pages/kept_heights.hpp"

namespace talus {

KeptHeights::KeptHeights(const StoredPages& pages, QueryCost& cost)
    : pages_(pages),
      cost_(cost),
      all_kept_(pages.manifest().description.kept_above().value == 0),
      largest_dropped_(largest_code_within(pages.manifest().description.kept_above().value)),
      bands_(static_cast<std::size_t>(pages.manifest().bands)) {}

const Page* KeptHeights::page_with(GridPoint p) {
  const int bands = pages_.manifest().bands;
  const PageId id = page_of(p, band_of(p, bands));
  Band& band = bands_[static_cast<std::size_t>(id.band)];
  if (band.page == nullptr || band.id != id) {
    band.page = nullptr;
    if (!pages_.transaction().has({id.band, curve_position(id)})) return nullptr;
    band.page = &pages_.get(id, 0, band.decoder, cost_);  // 0: updates need all samples, so there are none
    band.id = id;
  }
  return band.page;
}

bool KeptHeights::is_kept_for_its_error(const Page& page, std::int32_t col, std::int32_t row) const {
  return page.error(page.index(col, row), pages_.distance()) > largest_dropped_ ||
         is_near_border(page.grid.at(col, row), page.extent);
}

double KeptHeights::at(GridPoint p) {
  const Page* page = page_with(p);
  if (page == nullptr) return 0;
  const auto [col, row] = page->grid.local(p);
  if (is_kept(*page, col, row)) return page->heights[page->index(col, row)];
  const std::uint64_t key = std::uint64_t{static_cast<std::uint32_t>(p.col)} << 32 | static_cast<std::uint32_t>(p.row);
  if (const auto known = found_.find(key); known != found_.end()) return known->second;
  const Diamond d = diamond(p);
  const double height = at(d.ends[0]) / 2 + at(d.ends[1]) / 2;
  found_.emplace(key, height);
  return height;
}

}  // namespace talus
