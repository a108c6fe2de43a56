#include "query/selection/cover.hpp"

namespace talus {
namespace {

class Around {
 public:
  Around(GridRect region, GridRect extent, int finest_height, const Threshold& above, const ExtentBorder& border,
         NearbyPages& pages)
      : region_(region),
        extent_(extent),
        finest_height_(finest_height),
        above_(above),
        border_(border),
        pages_(pages) {}

  VerticesAround run() {
    for_each_root_triangle(extent_, [&](const Triangle& root) { visit(root); });
    return std::move(outside_);
  }

 private:
  void visit(const Triangle& t) {
    if (!meets(t, region_)) return;
    if (region_.contains(t.apex) && region_.contains(t.left) && region_.contains(t.right)) return;  // not on a side
    const GridPoint split = midpoint(t.left, t.right);
    if (is_finest(t) || !is_split(t, split)) {
      if (!is_finest(t) && !region_.contains(split)) leave_out(split);
      for (const GridPoint p : {t.apex, t.left, t.right}) {
        if (!region_.contains(p)) outside_.corners.push_back(p);
      }
      return;
    }
    if (!region_.contains(split)) outside_.splits.push_back(split);
    visit(left_half(t));
    visit(right_half(t));
  }

  void leave_out(GridPoint split) {
    if (const Page* page = pages_.page_of_vertex(split)) outside_.absent.take(*page, page->index(split));
  }

  /// The extent's border splits every triangle that leaves the extent, even if the split vertex lies outside.
  bool is_split(const Triangle& t, GridPoint split) {
    if (!extent_.contains(t.apex) || !extent_.contains(t.left) || !extent_.contains(t.right)) return true;
    if (border_.contains(split)) return true;
    if (height_in_tree(split) < finest_height_) return false;
    const Page* page = pages_.page_of_vertex(split);
    return page != nullptr && above_(*page, page->index(split));
  }

  GridRect region_, extent_;
  int finest_height_;
  const Threshold& above_;
  const ExtentBorder& border_;
  NearbyPages& pages_;
  VerticesAround outside_;
};

}  // namespace

VerticesAround vertices_around(GridRect region, GridRect extent, int finest_height, const Threshold& above,
                               const ExtentBorder& border, NearbyPages& pages) {
  return Around(region, extent, finest_height, above, border, pages).run();
}

}  // namespace talus
