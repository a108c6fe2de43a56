#include "query/pages/decoded_pages.hpp"

#include "talus/failure.hpp"

namespace talus {

DecodedPages::Found DecodedPages::read(PageId id) {
  Found found;
  try {
    if (!pages_.transaction().has({id.band, curve_position(id)})) return found;
    QueryCost unused;
    const Page& page = pages_.get(id, decoder_, unused, &found.generation);
    found.page = std::make_shared<const Page>(page);
  } catch (const Failure& f) {
    if (f.cause() != Cause::corrupt) throw;
    found.damage = f.what();
  }
  return found;
}

DecodedPages::Found DecodedPages::get(PageId id) {
  const Key key{id.band, curve_position(id)};
  if (const auto place = places_.find(key); place != places_.end()) {
    by_use_.splice(by_use_.begin(), by_use_, place->second);
    return by_use_.front().second;
  }
  by_use_.emplace_front(key, read(id));
  places_[key] = by_use_.begin();
  if (by_use_.size() > most_) {
    places_.erase(by_use_.back().first);
    by_use_.pop_back();
  }
  return by_use_.front().second;
}

}  // namespace talus
