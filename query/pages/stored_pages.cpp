#include "query/pages/stored_pages.hpp"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "engine/geo/ground.hpp"
#include "engine/geo/longitude.hpp"
#include "engine/machine/fail.hpp"
#include "engine/quadtree/extent_border.hpp"
#include "query/pages/stopwatch.hpp"
#include "storage/checksum.hpp"

namespace talus {

struct StoredPages::Lazy {
  std::once_flag once;
  std::optional<ExtentBorder> border;
  std::once_flag turn_once;
  double turn = 0;
  std::once_flag identity_once;
  Identity identity;
};

// Two different rasters may have the same manifest, so the digest also covers the provenance. The file's seal cannot be
// used: it changes when the same pages move in the file, and the path may name another file by now.
Identity StoredPages::identity() const {
  std::call_once(lazy_->identity_once, [&] {
    std::vector<std::byte> said;
    for (const std::uint64_t position : {kManifestPosition, kProvenancePosition}) {
      if (const auto page = txn_.find({kHeaderTable, position}))
        said.insert(said.end(), page->content.begin(), page->content.end());
    }
    const std::uint64_t digest = page_checksum({kHeaderTable, kManifestPosition}, manifest_.generation, said);
    lazy_->identity = {std::max<std::uint64_t>(digest, 1), manifest_.generation};
  });
  return lazy_->identity;
}

const ExtentBorder& StoredPages::extent_border() const {
  std::call_once(lazy_->once, [&] { lazy_->border.emplace(manifest_.description.extent); });
  return *lazy_->border;
}

Longitudes StoredPages::longitudes() const {
  std::call_once(lazy_->turn_once, [&] { lazy_->turn = Ground(manifest_.description.crs).full_turn(); });
  return {lazy_->turn, manifest_.description};
}

StoredPages::StoredPages(const PageStore& store, std::shared_ptr<PageCache> cache)
    : txn_(store), cache_(std::move(cache)), file_(store.file()), lazy_(std::make_shared<Lazy>()) {
  const auto header = txn_.find({kHeaderTable, kManifestPosition});
  if (!header) fail_in(file_, Cause::corrupt, "{}: not a Talus database: it has no header", file_.string());
  header_bytes_ = header->content.size() + kPagePrefixBytes;
  try {
    manifest_ = decode_manifest(header->content);
  } catch (const Failure& f) {
    fail_in(file_, f.cause(), "{}: {}", file_.string(), f.what());
  }
  distance_ = CodeDistance(manifest_.description);
}

namespace {

/// Null if a cost is not counted by band.
BandCost* band_in(QueryCost& cost, PageId id) {
  const auto band = static_cast<std::size_t>(id.band);
  return band < cost.bands.size() ? &cost.bands[band] : nullptr;
}

void count_slice(PageId tile, std::size_t content, QueryCost& cost) {
  const std::uint64_t bytes = content + kPagePrefixBytes + kTileDirectoryBytes;
  cost.bytes_read += bytes;
  if (BandCost* band = band_in(cost, tile)) ++band->slices_read, band->bytes_read += bytes;
}

}  // namespace

QueryCost StoredPages::cost_of_header() const {
  QueryCost cost;
  cost.pages_read = 1;
  cost.bytes_read = header_bytes_;
  cost.bands.resize(static_cast<std::size_t>(manifest_.bands));
  for (int band = 0; band < manifest_.bands; ++band)
    cost.bands[static_cast<std::size_t>(band)].spacing = band_spacing(band);
  return cost;
}

const Page& StoredPages::read(PageId id, std::optional<std::uint32_t> expected, Decode decode, PageDecoder& decoder,
                              QueryCost& cost, std::uint32_t* generation) const {
  const Stopwatch reading(cost.reading_seconds);
  const auto page = txn_.find({id.band, curve_position(id)});
  const auto corrupt = [&](const std::string& what) {
    fail_in(file_, Cause::corrupt, "corrupt: {}: page {}/{} of band {} is {}", file_.string(), id.x, id.y, id.band,
            what);
  };
  if (!page) corrupt("missing");
  const std::uint64_t bytes = page->content.size() + kPagePrefixBytes + (id.band == 1 ? kTileDirectoryBytes : 0);
  ++cost.pages_read;
  cost.bytes_read += bytes;
  if (BandCost* band = band_in(cost, id)) ++band->pages_read, band->bytes_read += bytes;
  if (page->generation != expected.value_or(page->generation))
    corrupt(fmt::format("stale: written by update {}, expected update {}", page->generation, *expected));
  if (generation != nullptr) *generation = page->generation;
  const auto other = [&](PageId of, PageDecoder::Content what) {
    const bool is_slice = what == PageDecoder::Content::slice;
    const auto found = txn_.find({is_slice ? kSliceTable : of.band, curve_position(of)});
    if (!found) return std::span<const std::byte>();
    // Pages are not counted: whoever reads a page read the page above it before, which says that the page is there.
    if (is_slice) count_slice(of, found->content.size(), cost);
    return found->content;
  };
  // Fails if the file became shorter meanwhile.
  try {
    const Page& decoded =
        (decoder.*decode)(id, manifest_.description.extent, manifest_.bands, distance_, page->content, other);
    txn_.require_all_bytes();
    return decoded;
  } catch (const Failure&) {
    txn_.require_all_bytes();
    throw;
  }
}

std::optional<std::int32_t> StoredPages::threshold_of_slice(PageId tile) const {
  const auto content = txn_.unchecked({kSliceTable, curve_position(tile)});
  if (content.empty()) return std::nullopt;
  return SliceCoder::threshold_of(content);
}

const TileSlice& StoredPages::slice(PageId tile, std::uint32_t generation, SliceCoder& coder, QueryCost& cost) const {
  const Stopwatch reading(cost.reading_seconds);
  const auto stored = txn_.find({kSliceTable, curve_position(tile)});
  const auto corrupt = [&](const std::string& what) {
    fail_in(file_, Cause::corrupt, "corrupt: {}: the slice of tile {}/{} is {}", file_.string(), tile.x, tile.y, what);
  };
  if (!stored) corrupt("missing");
  count_slice(tile, stored->content.size(), cost);
  if (stored->generation != generation)
    corrupt(fmt::format("stale: written by update {}, expected update {}", stored->generation, generation));
  try {
    const TileSlice& slice = coder.decode({tile.x, tile.y}, manifest_.description.extent, distance_, stored->content);
    txn_.require_all_bytes();
    return slice;
  } catch (const Failure&) {
    txn_.require_all_bytes();
    throw;
  }
}

const Page& StoredPages::get(PageId id, std::uint32_t generation, PageDecoder& decoder, QueryCost& cost) const {
  return read(id, generation, &PageDecoder::decode, decoder, cost);
}

const Page& StoredPages::get(PageId id, PageDecoder& decoder, QueryCost& cost, std::uint32_t* generation) const {
  return read(id, std::nullopt, &PageDecoder::decode, decoder, cost, generation);
}

const Page& StoredPages::get_heights(PageId id, std::uint32_t generation, PageDecoder& decoder, QueryCost& cost) const {
  return read(id, generation, &PageDecoder::decode_heights, decoder, cost);
}

std::shared_ptr<const Page> StoredPages::shared(PageId id, std::uint32_t generation, QueryCost& cost) const {
  const PageCache::Key key{id.band, curve_position(id), generation};
  if (auto page = cache_->find(key)) {
    ++cost.pages_cached;
    if (BandCost* band = band_in(cost, id)) ++band->pages_cached;
    return page;
  }
  const PageCache::BorrowedDecoder decoder = cache_->borrow_decoder();
  return cache_->keep(key, get(id, generation, decoder->pages, cost));
}

bool StoredPages::would_keep(GridRect region) const {
  const std::uint64_t bytes_a_sample = distance_.is_whole() ? 6 : 20;  // most pages of whole numbers are dense
  return static_cast<std::uint64_t>(region.samples()) <= cache_->most_bytes() / 2 / bytes_a_sample;
}

}  // namespace talus
