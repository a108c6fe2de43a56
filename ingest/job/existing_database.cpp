#include "ingest/job/existing_database.hpp"

#include <algorithm>

#include "engine/machine/fail.hpp"
#include "engine/page/page_codec.hpp"
#include "ingest/job/stored_bytes.hpp"
#include "ingest/mosaic/common_grid.hpp"

namespace talus {

ExistingDatabase::ExistingDatabase(const std::filesystem::path& database) : txn_(PageStore::open(database)) {
  const auto header = txn_.find({kHeaderTable, kManifestPosition});
  if (!header) fail(Cause::corrupt, "{}: not a Talus database: it has no header", database.string());
  try {
    manifest_ = decode_manifest(header->content);
  } catch (const Failure& f) {
    fail(f.cause(), "{}: {}", database.string(), f.what());
  }
}

Provenance ExistingDatabase::provenance() const {
  const auto stored = txn_.find({kHeaderTable, kProvenancePosition});
  return stored ? decode_provenance(stored->content) : Provenance{};
}

std::uint32_t ExistingDatabase::generation_of(PageKey key, std::span<const std::byte> content,
                                              std::uint32_t otherwise) const {
  const auto stored = txn_.find(key);
  const bool same =
      stored && std::equal(content.begin(), content.end(), stored->content.begin(), stored->content.end());
  return same ? stored->generation : otherwise;
}

void ExistingDatabase::fill(Window& window) const {
  const GridRect& extent = manifest_.description.extent;
  if (!overlap(window.region, extent)) return;
  const CodeDistance distance(manifest_.description);
  PageDecoder decoder;
  const GridRect shared = common(window.region, extent);
  const PageId first = page_of(shared.first, 0), last = page_of(shared.last, 0);
  for (std::int32_t y = first.y; y <= last.y; ++y) {
    for (std::int32_t x = first.x; x <= last.x; ++x) {
      const PageId id{0, x, y};
      const auto stored = txn_.find({0, curve_position(id)});
      if (!stored) continue;  // a page without data is not stored
      const Page& page =
          decoder.decode_heights(id, extent, manifest_.bands, distance, stored->content, content_in(txn_));
      txn_.require_all_bytes();
      for_each_in(page.grid, window.region, [&](std::size_t from, GridPoint p) {
        const std::size_t to = index_in(window.region, p);
        if (!page.is_data(from) || window.valid[to]) return;
        window.valid[to] = 1;
        set_code(window.codes, to, page.height(from));
      });
    }
  }
}

}  // namespace talus
