#include "query/pages/page_cache.hpp"

#include <algorithm>

namespace talus {
namespace {

/// With sixteen shards, threads rarely wait for one another. A shard should hold several pages of about 256 KiB, so a
/// small cache has fewer shards.
constexpr std::uint64_t kMostShards = 16, kLeastBytesOfShard = std::uint64_t{4} << 20;

template <class T>
std::uint64_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

std::uint64_t bytes_of(const Page& page) {
  return sizeof(Page) + bytes_of(page.squares) + bytes_of(page.heights) + bytes_of(page.errors) + bytes_of(page.coded) +
         bytes_of(page.in_slice) + bytes_of(page.eighths) + bytes_of(page.distances) + bytes_of(page.valid) +
         bytes_of(page.covers) + bytes_of(page.children);
}

}  // namespace

PageCache::PageCache(std::uint64_t most_bytes)
    : shards_(std::clamp<std::uint64_t>(most_bytes / kLeastBytesOfShard, 1, kMostShards)),
      most_bytes_of_shard_(most_bytes / shards_.size()) {}

std::size_t PageCache::Hash::operator()(const Key& key) const {
  // Spreads neighbours on the curve over the shards, because they are read together.
  const std::uint64_t mixed =
      (key.position + static_cast<std::uint64_t>(key.band) * 0x9e3779b97f4a7c15) ^ std::uint64_t{key.generation} << 32;
  return static_cast<std::size_t>(mixed * 0x9e3779b97f4a7c15 >> 24);
}

PageCache::Shard& PageCache::shard_of(const Key& key) { return shards_[Hash()(key) % shards_.size()]; }

std::shared_ptr<const Page> PageCache::find(const Key& key) {
  if (most_bytes_of_shard_ == 0) return nullptr;
  Shard& shard = shard_of(key);
  const std::lock_guard lock(shard.mutex);
  const auto found = shard.places.find(key);
  if (found == shard.places.end()) return nullptr;
  shard.by_use.splice(shard.by_use.begin(), shard.by_use, found->second);
  return found->second->page;
}

std::shared_ptr<const Page> PageCache::keep(const Key& key, const Page& page) {
  auto mine = copy(page);
  const std::uint64_t bytes = bytes_of(*mine);
  if (bytes > most_bytes_of_shard_) return mine;
  std::list<Kept> dropped;  // destroyed after the lock: pages are recycled without the lock
  Shard& shard = shard_of(key);
  const std::lock_guard lock(shard.mutex);
  if (const auto found = shard.places.find(key); found != shard.places.end()) return found->second->page;
  while (shard.bytes + bytes > most_bytes_of_shard_) {
    const auto oldest = std::prev(shard.by_use.end());
    shard.bytes -= oldest->bytes;
    shard.places.erase(oldest->key);
    dropped.splice(dropped.begin(), shard.by_use, oldest);
  }
  shard.by_use.push_front({key, mine, bytes});
  shard.places.emplace(key, shard.by_use.begin());
  shard.bytes += bytes;
  return mine;
}

std::shared_ptr<const Page> PageCache::copy(const Page& page) const {
  std::unique_ptr<Page> memory;
  {
    const std::lock_guard lock(recycled_->mutex);
    if (!recycled_->pages.empty()) {
      memory = std::move(recycled_->pages.back());
      recycled_->pages.pop_back();
    }
  }
  if (!memory) memory = std::make_unique<Page>();
  *memory = page;
  return {memory.release(), [recycled = recycled_](const Page* given) {
            std::unique_ptr<Page> back(const_cast<Page*>(given));  // safe: it was made as a mutable Page above
            const std::lock_guard lock(recycled->mutex);
            if (recycled->pages.size() < recycled->decoders_made) recycled->pages.push_back(std::move(back));
          }};
}

PageCache::BorrowedDecoder PageCache::borrow_decoder() {
  const std::lock_guard lock(recycled_->mutex);
  if (recycled_->decoders.empty()) {
    recycled_->decoders.push_back(std::make_unique<Decoders>());
    ++recycled_->decoders_made;
    // Reserved here, because the return of a decoder or page must not need memory.
    recycled_->decoders.reserve(recycled_->decoders_made);
    recycled_->pages.reserve(recycled_->decoders_made);
  }
  BorrowedDecoder borrowed(recycled_->decoders.back().release(), GiveBack{recycled_});
  recycled_->decoders.pop_back();
  return borrowed;
}

void PageCache::GiveBack::operator()(Decoders* decoder) const {
  std::unique_ptr<Decoders> back(decoder);
  const std::lock_guard lock(to->mutex);
  to->decoders.push_back(std::move(back));
}

std::uint64_t PageCache::bytes() const {
  std::uint64_t bytes = 0;
  for (const Shard& shard : shards_) {
    const std::lock_guard lock(shard.mutex);
    bytes += shard.bytes;
  }
  return bytes;
}

}  // namespace talus
