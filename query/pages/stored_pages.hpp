#pragma once
// The pages of one consistent view, decoded on demand.

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/page/manifest.hpp"
#include "engine/page/page_codec.hpp"
#include "query/pages/page_cache.hpp"
#include "storage/page_store.hpp"
#include "talus/database.hpp"

namespace talus {

class ExtentBorder;
class Longitudes;

/// May be asked from several threads at once.
class StoredPages {
 public:
  /// fails  corrupt, unsupported: no header, a damaged one, another version
  StoredPages(const PageStore& store, std::shared_ptr<PageCache> cache);

  [[nodiscard]] const Manifest& manifest() const { return manifest_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const CodeDistance& distance() const { return distance_; }
  [[nodiscard]] const ReadTxn& transaction() const { return txn_; }
  /// Of the whole raster, made when first asked for.
  [[nodiscard]] const ExtentBorder& extent_border() const;
  /// Of a geographic CRS, where longitudes a full turn apart are one place.
  [[nodiscard]] Longitudes longitudes() const;
  /// Of what the header's pages say, read when first asked for. An update changes it even where it changes nothing
  /// else.
  [[nodiscard]] Identity identity() const;
  /// Nothing was asked yet; every band is there to be counted in.
  [[nodiscard]] QueryCost cost_of_header() const;

  /// For one thread's question.
  [[nodiscard]] PageCache::BorrowedDecoder borrow_decoder() const { return cache_->borrow_decoder(); }

  /// A page that must be there, of the generation that the page above it (or the header) says; until the decoder's
  /// next. Adds what it cost.
  /// fails  corrupt: missing, stale or damaged; io: the file has become shorter, or its disk fails
  [[nodiscard]] const Page& get(PageId id, std::uint32_t generation, PageDecoder& decoder, QueryCost& cost) const;
  /// The same page to share, for as long as it is held: from the cache if it is there, which counts as cached and not
  /// as read, else read and left in the cache.
  [[nodiscard]] std::shared_ptr<const Page> shared(PageId id, std::uint32_t generation, QueryCost& cost) const;
  /// Whether the pages of a region are few enough to leave them in the cache, beside others.
  [[nodiscard]] bool would_keep(GridRect region) const;
  /// The same of whatever generation: for those that come past the pages above it.
  [[nodiscard]] const Page& get(PageId id, PageDecoder& decoder, QueryCost& cost, std::uint32_t* generation) const;
  /// A page without its errors.
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
