#include "query/stored_pages.hpp"

#include <fmt/format.h>

#include "storage/checksum.hpp"

namespace talus {

StoredPages::StoredPages(const PageStore& store) : txn_(store), file_(store.file()) {
  const auto header = txn_.find({kHeaderTable, kManifestPosition});
  if (!header) throw Failure(Cause::corrupt, fmt::format("{}: not a Talus database: it has no header", file_.string()));
  header_bytes_ = header->content.size() + kPagePrefixBytes;
  try {
    manifest_ = decode_manifest(header->content);
  } catch (const Failure& f) {
    throw Failure(f.cause(), fmt::format("{}: {}", file_.string(), f.what()));
  }
  distance_ = CodeDistance(manifest_.description.step, manifest_.description.metres_per_unit);
}

const Page& StoredPages::get(PageId id, std::uint32_t generation, PageDecoder& decoder, QueryCost& cost) const {
  std::uint32_t found = 0;
  const Page& page = get(id, decoder, cost, &found);
  if (found != generation) {
    throw Failure(Cause::corrupt,
                  fmt::format("corrupt: {}: page {}/{} of band {} is stale: written by update {}, {} is expected",
                              file_.string(), id.x, id.y, id.band, found, generation));
  }
  return page;
}

const Page& StoredPages::get(PageId id, PageDecoder& decoder, QueryCost& cost, std::uint32_t* generation) const {
  const auto stored = txn_.find({id.band, curve_position(id)});
  if (!stored) {
    throw Failure(Cause::corrupt,
                  fmt::format("corrupt: {}: page {}/{} of band {} is missing", file_.string(), id.x, id.y, id.band));
  }
  ++cost.pages_read;
  cost.bytes_read += stored->content.size() + kPagePrefixBytes;
  if (generation != nullptr) *generation = stored->generation;
  return decoder.decode(id, manifest_.description.extent, manifest_.bands, stored->content);
}

}  // namespace talus
