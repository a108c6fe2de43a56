#include "query/selection/increment.hpp"

#include <utility>

#include <fmt/format.h>

#include "query/selection/range_query.hpp"
#include "query/selection/refusals.hpp"

namespace talus {

Increment increment_query(const StoredPages& pages, GridRect region, Metres from, Metres to, int threads) {
  require_inside(pages, region);
  require_tolerance(from);
  require_tolerance(to);
  if (!(to < from)) {
    throw Failure(Cause::invalid_argument,
                  fmt::format("increment from {} m to {} m: the tolerance must be below the one to go on from",
                              from.value, to.value));
  }
  Answer added = range_query(pages, region, to, threads, from);
  return {std::move(added.quadtree), from, std::move(added.cost)};
}

}  // namespace talus
