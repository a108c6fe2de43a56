#pragma once
// The pages of one consistent view, decoded on demand.

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/page/manifest.hpp"
#include "engine/page/page_codec.hpp"
#include "engine/page/tile_slice.hpp"
#include "query/pages/page_cache.hpp"
#include "storage/page_store.hpp"
#include "talus/database.hpp"

namespace talus {

class ExtentBorder;
class Longitudes;

/// The pages of one snapshot. Several threads may use it at once.
class StoredPages {
 public:
  /// fails  corrupt: no header, or a damaged one; unsupported: another version
  StoredPages(const PageStore& store, std::shared_ptr<PageCache> cache);

  [[nodiscard]] const Manifest& manifest() const { return manifest_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const CodeDistance& distance() const { return distance_; }
  [[nodiscard]] const ReadTxn& transaction() const { return txn_; }
  /// The border of the whole raster, made by the first call.
  [[nodiscard]] const ExtentBorder& extent_border() const;
  /// The longitudes of the raster. In a geographic CRS, longitudes a full turn apart are one place.
  [[nodiscard]] Longitudes longitudes() const;
  /// A digest of the header's pages, computed by the first call. Every update changes it.
  [[nodiscard]] Identity identity() const;
  /// The cost of the header, with an empty count for each band. Every question starts with it.
  [[nodiscard]] QueryCost cost_of_header() const;

  /// A decoder for one thread.
  [[nodiscard]] PageCache::BorrowedDecoder borrow_decoder() const { return cache_->borrow_decoder(); }

  /// Reads a page that must exist, in the generation that its parent page or the header says. It is valid until the
  /// decoder decodes another page. Adds to the cost.
  /// fails  corrupt: a missing, stale or damaged page; io: the file has become shorter, or its disk fails
  [[nodiscard]] const Page& get(PageId id, std::uint32_t generation, PageDecoder& decoder, QueryCost& cost) const;
  /// The same page, valid as long as it is held. From the cache it counts as cached; otherwise it is read, counts as
  /// read, and is added to the cache.
  [[nodiscard]] std::shared_ptr<const Page> shared(PageId id, std::uint32_t generation, QueryCost& cost) const;
  /// Whether the pages of a region fit into half of the cache.
  [[nodiscard]] bool would_keep(GridRect region) const;
  /// The same for any generation, which it returns. For callers that have not read the parent page.
  [[nodiscard]] const Page& get(PageId id, PageDecoder& decoder, QueryCost& cost, std::uint32_t* generation) const;
  /// The threshold that the slice of a tile says it has, not checked: good enough to decide whether to read it. Nothing:
  /// there is none.
  [[nodiscard]] std::optional<std::int32_t> threshold_of_slice(PageId tile) const;
  /// The slice of a tile whose page of band 1 has this id and generation; valid until the coder decodes another slice.
  /// Adds to the cost.
  /// fails  as for a page
  [[nodiscard]] const TileSlice& slice(PageId tile, std::uint32_t generation, SliceCoder& coder, QueryCost& cost) const;
  /// Reads a page without its errors.
  [[nodiscard]] const Page& get_heights(PageId id, std::uint32_t generation, PageDecoder& decoder,
                                        QueryCost& cost) const;

 private:
  using Decode = decltype(&PageDecoder::decode);
  /// expected  the generation it must have; empty: any, which `generation` receives
  [[nodiscard]] const Page& read(PageId id, std::optional<std::uint32_t> expected, Decode decode, PageDecoder& decoder,
                                 QueryCost& cost, std::uint32_t* generation = nullptr) const;

  ReadTxn txn_;
  std::shared_ptr<PageCache> cache_;
  std::filesystem::path file_;
  Manifest manifest_;
  CodeDistance distance_;
  std::uint64_t header_bytes_ = 0;
  struct Lazy;
  std::shared_ptr<Lazy> lazy_;
};

}  // namespace talus
