#pragma once
// The way down through the pages of a region. Only the parent page knows whether a page is missing or has only voids.

#include "engine/page/manifest.hpp"
#include "engine/page/page_codec.hpp"

namespace talus {

/// Calls visit(id, generation) for the pages of the coarsest band that overlap a region. Every descent begins there.
template <class Visit>
void for_each_top(const Manifest& manifest, GridRect region, Visit&& visit) {
  const std::vector<PageId> tops = pages_of_band(manifest.bands - 1, manifest.description.extent);
  for (std::size_t i = 0; i < tops.size(); ++i) {
    if (overlap(page_square(tops[i]), region)) visit(tops[i], manifest.top_generations[i]);
  }
}

/// Calls visit(id, entry) for the stored child pages of `id` that overlap a region.
template <class Visit>
void for_each_child(PageId id, std::span<const ChildEntry> children, GridRect region, Visit&& visit) {
  for (std::size_t i = 0; i < children.size(); ++i) {
    const PageId child = child_page(id, i);
    if (children[i].present && overlap(page_square(child), region)) visit(child, children[i]);
  }
}
template <class Visit>
void for_each_child(const Page& page, GridRect region, Visit&& visit) {
  for_each_child(page.id, page.children, region, visit);
}

}  // namespace talus
