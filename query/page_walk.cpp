#include "query/page_walk.hpp"

#include <algorithm>

namespace talus {

PageWalk::PageWalk(const StoredPages& pages, QueryCost& cost)
    : pages_(pages),
      cost_(cost),
      tops_(pages_of_band(pages.manifest().bands - 1, pages.manifest().description.extent)),
      last_(static_cast<std::size_t>(pages.manifest().bands)),
      known_(last_.size()) {}

std::optional<ChildEntry> PageWalk::entry(PageId id) {
  if (id.band == pages_.manifest().bands - 1) {
    const auto top = std::find(tops_.begin(), tops_.end(), id);
    if (top == tops_.end()) return std::nullopt;
    ChildEntry entry{true, kAlwaysSelected, 0, 0, 0};
    entry.generation = pages_.manifest().top_generations[static_cast<std::size_t>(top - tops_.begin())];
    return entry;
  }
  const Below* table = below(parent_page(id));
  if (table == nullptr) return std::nullopt;
  const auto mask = kChildrenAcross - 1;
  const ChildEntry& entry = (*table)[static_cast<std::size_t>((id.y & mask) * kChildrenAcross + (id.x & mask))];
  return entry.present ? std::optional(entry) : std::nullopt;
}

const PageWalk::Below* PageWalk::below(PageId id) {
  auto& known = known_[static_cast<std::size_t>(id.band)];
  const auto found = known.find(curve_position(id));
  if (found != known.end()) return &found->second;
  const std::shared_ptr<const Page> page = find(id);
  return page == nullptr ? nullptr : &known.emplace(curve_position(id), page->children).first->second;
}

std::shared_ptr<const Page> PageWalk::find(PageId id) {
  Last& last = last_[static_cast<std::size_t>(id.band)];
  if (last.page != nullptr && last.id == id) return last.page;
  const std::optional<ChildEntry> said = entry(id);
  if (!said) return nullptr;
  last = {id, pages_.shared(id, said->generation, cost_)};
  return last.page;
}

}  // namespace talus
