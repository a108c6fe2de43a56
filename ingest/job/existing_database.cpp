#include "ingest/job/existing_database.hpp"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "engine/page/page_codec.hpp"
#include "ingest/mosaic/common_grid.hpp"
#include "talus/failure.hpp"

namespace talus {

ExistingDatabase::ExistingDatabase(const std::filesystem::path& database) : txn_(PageStore::open(database)) {
  const auto header = txn_.find({kHeaderTable, kManifestPosition});
  if (!header)
    throw Failure(Cause::corrupt, fmt::format("{}: not a Talus database: it has no header", database.string()));
  try {
    manifest_ = decode_manifest(header->content);
  } catch (const Failure& f) {
    throw Failure(f.cause(), fmt::format("{}: {}", database.string(), f.what()));
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
  const CodeDistance distance(manifest_.description.step, manifest_.description.metres_per_unit);
  PageDecoder decoder;
  const GridRect shared = common(window.region, extent);
  const PageId first = page_of(shared.first, 0), last = page_of(shared.last, 0);
  for (std::int32_t y = first.y; y <= last.y; ++y) {
    for (std::int32_t x = first.x; x <= last.x; ++x) {
      const PageId id{0, x, y};
      const auto stored = txn_.find({0, curve_position(id)});
      if (!stored) continue;  // a page without data is not stored
      const Page& page = decoder.decode_heights(id, extent, manifest_.bands, distance, stored->content);
      txn_.require_all_bytes();
      for (std::int32_t row = 0; row < page.grid.rows; ++row) {
        for (std::int32_t col = 0; col < page.grid.cols; ++col) {
          const GridPoint p = page.grid.at(col, row);
          const std::size_t from = page.index(col, row);
          if (!window.region.contains(p) || (!page.valid.empty() && !page.valid[from])) continue;
          const std::size_t to = index_in(window.region, p);
          if (window.valid[to]) continue;
          window.valid[to] = 1;
          std::visit(
              [&](auto& codes) {
                codes[to] =
                    static_cast<typename std::remove_reference_t<decltype(codes)>::value_type>(page.heights[from]);
              },
              window.codes);
        }
      }
    }
  }
}

}  // namespace talus
