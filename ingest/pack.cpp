#include "ingest/pack.hpp"

#include <algorithm>
#include <unordered_map>

namespace talus {
namespace {

class Packer {
 public:
  explicit Packer(const PackInput& input)
      : in_(input), field_(input.errors_from.field), extent_(field_.extent), bands_(input.manifest.bands) {}

  void run(const std::function<void(const Page&)>& take) {
    for (int band = 0; band < bands_; ++band) {
      std::unordered_map<std::uint64_t, ChildEntry> entries;
      for (const PageId id : pages_of_band(band, extent_)) {
        Page page = heights_of(id);
        const ChildEntry entry = complete(page);
        if (!entry.present) continue;
        entries.emplace(curve_position(id), entry);
        take(page);
      }
      below_ = std::move(entries);
    }
  }

 private:
  [[nodiscard]] Page heights_of(PageId id) const {
    Page page;
    page.id = id;
    page.bands = bands_;
    page.grid = page_grid(id, extent_);
    const std::size_t n = page.grid.size();
    page.heights.resize(n);
    page.errors.assign(n, 0);
    if (!in_.valid.empty()) page.valid.resize(n);
    for (std::int32_t row = 0; row < page.grid.rows; ++row) {
      for (std::int32_t col = 0; col < page.grid.cols; ++col) {
        const std::size_t from = field_.index(page.grid.at(col, row)), to = page.index(col, row);
        page.heights[to] = field_.heights[from];
        if (!in_.valid.empty()) page.valid[to] = in_.valid[from];
      }
    }
    if (std::find(page.valid.begin(), page.valid.end(), 0) == page.valid.end()) page.valid.clear();
    return page;
  }

  /// Errors, triangles with data, the table of pages below; returns what the page above must know.
  ChildEntry complete(Page& page) const {
    ChildEntry entry = range_of(page, in_.manifest.description.step);
    entry.present = entry.lowest <= entry.highest || page.id.band == bands_ - 1;  // a query starts at the coarsest
    if (in_.errors_from.voids != nullptr) page.covers.assign(page.grid.size(), 0);
    bool covers_differ = false;
    for (std::int32_t row = 0; row < page.grid.rows; ++row) {
      for (std::int32_t col = 0; col < page.grid.cols; ++col) {
        const GridPoint p = page.grid.at(col, row);
        const std::size_t i = page.index(col, row);
        if (!page.is_own(p)) continue;
        page.errors[i] = spacing(p) >= in_.errors.root() ? kAlwaysSelected : in_.errors[p];
        if (!page.covers.empty()) {
          const std::uint8_t with_data =
              spacing(p) >= in_.errors.root() ? 15 : in_.errors_from.voids->apex_triangles_with_data(p);
          entry.present = entry.present || with_data != 0 || page.errors[i] != 0;
          page.covers[i] = static_cast<std::uint8_t>(with_data | leaving_extent(p));
          covers_differ = covers_differ || page.covers[i] != 15;
        }
        entry.largest = std::max(entry.largest, page.errors[i]);
      }
    }
    if (!covers_differ && page.valid.empty()) page.covers.clear();
    return with_children(page, entry);
  }

  /// Triangles that leave the extent are never in a mesh; their bits are 1, so that pages of data only need none.
  [[nodiscard]] std::uint8_t leaving_extent(GridPoint p) const {
    if (spacing(p) == kRootSpacing) return 15;
    std::uint8_t bits = 0;
    const auto triangles = apex_triangles(p);
    for (std::size_t i = 0; i < 4; ++i) {
      if (!extent_.contains(triangles[i].left) || !extent_.contains(triangles[i].right))
        bits = static_cast<std::uint8_t>(bits | 1u << i);
    }
    return bits;
  }

  [[nodiscard]] ChildEntry with_children(Page& page, ChildEntry entry) const {
    if (page.id.band == 0) return entry;
    page.children.resize(static_cast<std::size_t>(kChildrenAcross) * kChildrenAcross);
    for (std::size_t i = 0; i < page.children.size(); ++i) {
      const auto found = below_.find(curve_position(child_page(page.id, i)));
      if (found == below_.end()) continue;
      page.children[i] = found->second;
      entry = joined(entry, found->second);
    }
    return entry;
  }

  const PackInput& in_;
  const HeightField& field_;
  GridRect extent_;
  int bands_;
  std::unordered_map<std::uint64_t, ChildEntry> below_;  // of the band before
};

}  // namespace

void pack(const PackInput& input, const std::function<void(const Page&)>& take) { Packer(input).run(take); }

}  // namespace talus
