#include "query/pages/nearby_pages.hpp"

#include <algorithm>

namespace talus {

const Page* NearbyPages::page(PageId id) { return page_at(place(id)); }

const Page* NearbyPages::page_of_vertex(GridPoint p) { return page(page_of(p, band_of(p, pages_.manifest().bands))); }

const Page* NearbyPages::page_at(Place& place) {
  if (!place.page && place.entry.present) {
    watch_.look();
    place.page = pages_.shared(place.id, place.entry.generation, cost_);
  }
  return place.page.get();
}

NearbyPages::Place& NearbyPages::place(PageId id) {
  Place& place = bands_[static_cast<std::size_t>(id.band)][static_cast<std::size_t>((id.x & 1) | (id.y & 1) << 1)];
  if (place.id == id) return place;
  place.id.band = -1;  // this place stays empty if a page above fails
  place.page = nullptr;
  place.entry = look_up(id);
  place.id = id;
  return place;
}

ChildEntry NearbyPages::look_up(PageId id) {
  const Manifest& manifest = pages_.manifest();
  if (id.band == manifest.bands - 1) {
    const auto top = std::find(tops_.begin(), tops_.end(), id);
    if (top == tops_.end()) return {};
    ChildEntry entry;
    entry.present = true;
    entry.largest = kAlwaysSelected;
    entry.generation = manifest.top_generations[static_cast<std::size_t>(top - tops_.begin())];
    return entry;
  }
  const Page* above = page_at(place(parent_page(id)));
  if (above == nullptr) return {};
  constexpr std::int32_t kWithin = kChildrenAcross - 1;
  return above->children[static_cast<std::size_t>((id.y & kWithin) * kChildrenAcross + (id.x & kWithin))];
}

}  // namespace talus
