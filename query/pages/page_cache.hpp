#pragma once
// Decoded pages that several questions, snapshots and threads share.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "engine/page/page_codec.hpp"

namespace talus {

/// Keeps what was used last, up to a number of bytes. May be asked from several threads at once; a page that was handed
/// out stays valid for as long as somebody holds it, kept or not.
///
/// Memory is used again rather than given back: a page that nobody holds any more becomes the memory of the next, and
/// decoders wait for the next who needs one. Memory that is fresh from the system costs more than to decode into it
/// (bench_query, BM_PageCache).
class PageCache {
 public:
  /// most_bytes  of all pages kept, 0: none is kept. A page larger than a shard's part is not kept either.
  explicit PageCache(std::uint64_t most_bytes);

  struct Key {
    int band = 0;
    std::uint64_t position = 0;  ///< on the curve of the band
    std::uint32_t generation = 0;
    friend bool operator==(const Key&, const Key&) = default;
  };

  /// The page, now the last to go; null if it is not kept.
  [[nodiscard]] std::shared_ptr<const Page> find(const Key& key);
  /// A copy of a page to hold, and to find. Of two threads that decoded the same page both get the first one's.
  [[nodiscard]] std::shared_ptr<const Page> keep(const Key& key, const Page& page);

  struct GiveBack;
  using BorrowedDecoder = std::unique_ptr<PageDecoder, GiveBack>;
  /// One that nobody else uses.
  [[nodiscard]] BorrowedDecoder borrow_decoder();

  [[nodiscard]] std::uint64_t most_bytes() const { return most_bytes_of_shard_ * shards_.size(); }
  /// Of all pages kept now: never more than the bound.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  /// What is used again. Pages outlive the cache where somebody holds one: they share this.
  struct Recycled {
    std::mutex mutex;
    std::vector<std::unique_ptr<PageDecoder>> decoders;
    std::vector<std::unique_ptr<Page>> pages;  ///< at most one for each decoder
    std::size_t decoders_made = 0;             ///< as many as threads ever decoded at once
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  struct Kept {
    Key key;
    std::shared_ptr<const Page> page;
    std::uint64_t bytes = 0;
  };
  struct Shard {
    mutable std::mutex mutex;
    std::list<Kept> by_use;  ///< last used first
    std::unordered_map<Key, std::list<Kept>::iterator, Hash> places;
    std::uint64_t bytes = 0;
  };
  [[nodiscard]] Shard& shard_of(const Key& key);
  [[nodiscard]] std::shared_ptr<const Page> copy(const Page& page) const;

  std::shared_ptr<Recycled> recycled_ = std::make_shared<Recycled>();
  std::vector<Shard> shards_;
  std::uint64_t most_bytes_of_shard_;
};

/// Hands a decoder back to its cache.
struct PageCache::GiveBack {
  std::shared_ptr<Recycled> to;
  void operator()(PageDecoder* decoder) const;
};

}  // namespace talus
