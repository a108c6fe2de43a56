#include "query/pages/page_fates.hpp"

namespace talus {

PageFates::PageFates(const StoredPages& pages, GridRect region, QueryCost& cost, int finest_height)
    : manifest_(pages.manifest()), region_(region), cost_(cost), finest_height_(finest_height) {
  cost_.bands.resize(static_cast<std::size_t>(manifest_.bands));
}

void PageFates::begin() {
  for (int b = 0; b < manifest_.bands; ++b) {
    const PageId first = page_of(region_.first, b), last = page_of(region_.last, b);
    cost_.bands[static_cast<std::size_t>(b)].in_region =
        static_cast<std::uint64_t>(last.x - first.x + 1) * static_cast<std::uint64_t>(last.y - first.y + 1);
  }
  for (const PageId top : pages_of_band(manifest_.bands - 1, manifest_.description.extent)) ++left_out(top);
}

std::uint64_t& PageFates::left_out(PageId id) {
  if (!overlap(page_square(id), region_)) return band(id).outside;
  // The coarsest band also has all coarser levels, so it is never too fine.
  const bool is_too_fine = band_shift(id.band + 1) <= finest_height_ && id.band + 1 < manifest_.bands;
  return is_too_fine ? band(id).too_fine : band(id).below_tolerance;
}

void PageFates::look_into(const Page& page, bool is_wanted) {
  BandCost& here = band(page.id);
  --left_out(page.id);
  ++(!overlap(page_square(page.id), region_) ? here.beyond : is_wanted ? here.wanted : here.needed);
  for (std::size_t i = 0; i < page.children.size(); ++i) {
    const PageId child = child_page(page.id, i);
    if (!overlap(page_square(child), manifest_.description.extent)) continue;
    const bool is_missing = !page.children[i].present && overlap(page_square(child), region_);
    ++(is_missing ? band(child).only_voids : left_out(child));
  }
}

}  // namespace talus
