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
#include "engine/page/tile_slice.hpp"

namespace talus {

/// What one thread decodes with.
struct Decoders {
  PageDecoder pages;
  SliceCoder slices;
};

/// Keeps the pages used last, up to a number of bytes. Several threads may use it at once. A page stays valid while a
/// caller holds it, even when the cache has dropped it.
///
/// The memory of pages and decoders that nobody holds is used again. Fresh memory from the system would cost more time
/// than the decoding (bench_query, BM_PageCache).
class PageCache {
 public:
  /// most_bytes  memory for all kept pages; 0: none is kept. A page larger than a shard is not kept either.
  explicit PageCache(std::uint64_t most_bytes);

  struct Key {
    int band = 0;
    std::uint64_t position = 0;  ///< position on the curve of the band
    std::uint32_t generation = 0;
    friend bool operator==(const Key&, const Key&) = default;
  };

  /// The page, or null if it is not kept. The cache drops it after all others.
  [[nodiscard]] std::shared_ptr<const Page> find(const Key& key);
  /// Keeps a copy of a page and returns it. If two threads decoded the same page, both get the first copy.
  [[nodiscard]] std::shared_ptr<const Page> keep(const Key& key, const Page& page);

  struct GiveBack;
  using BorrowedDecoder = std::unique_ptr<Decoders, GiveBack>;
  /// Decoders that nobody else uses. They return to the cache when this is destroyed.
  [[nodiscard]] BorrowedDecoder borrow_decoder();

  [[nodiscard]] std::uint64_t most_bytes() const { return most_bytes_of_shard_ * shards_.size(); }
  /// Memory of all pages that are kept now; at most most_bytes().
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  /// Memory to be used again. Pages share it, because a page may outlive the cache.
  struct Recycled {
    std::mutex mutex;
    std::vector<std::unique_ptr<Decoders>> decoders;
    std::vector<std::unique_ptr<Page>> pages;  ///< at most one for each decoder
    std::size_t decoders_made = 0;             ///< the most threads that decoded at once
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
    std::list<Kept> by_use;  ///< the page used last comes first
    std::unordered_map<Key, std::list<Kept>::iterator, Hash> places;
    std::uint64_t bytes = 0;
  };
  [[nodiscard]] Shard& shard_of(const Key& key);
  [[nodiscard]] std::shared_ptr<const Page> copy(const Page& page) const;

  std::shared_ptr<Recycled> recycled_ = std::make_shared<Recycled>();
  std::vector<Shard> shards_;
  std::uint64_t most_bytes_of_shard_;
};

/// Returns a decoder to its cache.
struct PageCache::GiveBack {
  std::shared_ptr<Recycled> to;
  void operator()(Decoders* decoder) const;
};

}  // namespace talus
