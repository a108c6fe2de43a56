#include "query/stored_pages.hpp"

#include <fmt/format.h>

#include "storage/checksum.hpp"

namespace talus {

StoredPages::StoredPages(const PageStore& store) : txn_(store), file_(store.file()) {
  const auto header = txn_.find({kHeaderTable, 0});
  if (!header) throw Failure(Cause::corrupt, fmt::format("{}: not a Talus database: it has no header", file_.string()));
  header_bytes_ = header->size() + kChecksumBytes;
  try {
    manifest_ = decode_manifest(*header);
  } catch (const Failure& f) {
    throw Failure(f.cause(), fmt::format("{}: {}", file_.string(), f.what()));
  }
  distance_ = CodeDistance(manifest_.description.step, manifest_.description.metres_per_unit);
}

std::span<const std::byte> StoredPages::find(PageId id, QueryCost& cost) const {
  const auto bytes = txn_.find({id.band, curve_position(id)});
  if (!bytes) {
    throw Failure(Cause::corrupt,
                  fmt::format("corrupt: {}: page {}/{} of band {} is missing", file_.string(), id.x, id.y, id.band));
  }
  ++cost.pages_read;
  cost.bytes_read += bytes->size() + kChecksumBytes;
  return *bytes;
}

const Page& StoredPages::get(PageId id, PageDecoder& decoder, QueryCost& cost) const {
  return decoder.decode(id, manifest_.description.extent, manifest_.bands, distance_, find(id, cost));
}

const Page& StoredPages::get_heights(PageId id, PageDecoder& decoder, QueryCost& cost) const {
  return decoder.decode_heights(id, manifest_.description.extent, manifest_.bands, find(id, cost));
}

}  // namespace talus
