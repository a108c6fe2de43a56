#include "query/selection/vertex_errors.hpp"

#include <fmt/format.h>

#include "query/pages/nearby_pages.hpp"
#include "query/selection/refusals.hpp"

namespace talus {

std::vector<double> vertex_errors(const StoredPages& pages, const RestrictedQuadtree& answer) {
  std::vector<double> errors;
  if (answer.vertices.size() == 0) return errors;
  require_inside(pages, answer.vertices.region());
  errors.reserve(answer.vertices.size());
  QueryCost unused;
  NearbyPages nearby(pages, unused);  // rows of vertices come back to the same pages: the cache has them
  answer.vertices.for_each([&](GridPoint p) {
    const Page* page = nearby.page_of_vertex(p);
    if (page == nullptr) {
      throw Failure(Cause::corrupt,
                    fmt::format("corrupt: {}: no page has the error of the vertex at column {}, row {}",
                                pages.file().string(), p.col, p.row),
                    pages.file());
    }
    const std::size_t i = page->index(p);
    errors.push_back(page->is_implied(i) ? pages.distance().metres(page->implied_distance(i))
                                         : error_of(page->errors[i]));
  });
  return errors;
}

}  // namespace talus
