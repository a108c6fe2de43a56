#include "tests/support/forged_database.hpp"

#include <algorithm>
#include <optional>

#include "engine/page/digest.hpp"
#include "engine/page/tile_slice.hpp"
#include "tests/support/given_page.hpp"

namespace talus::support {

Forgery::Forgery(const std::filesystem::path& database, Corners corners) {
  const ReadTxn txn(PageStore::open(database));
  for (int table = kHeaderTable; table <= kSliceTable; ++table) {
    txn.for_each(table, [&](std::uint64_t position) {
      const auto found = txn.find({table, position});
      stored[{table, position}] = {{found->content.begin(), found->content.end()}, found->generation};
    });
  }
  if (corners == Corners::as_stored || !stored.contains({kHeaderTable, kManifestPosition})) return;
  std::vector<Page> pages;
  for (const auto& [at, any] : stored) {
    if (at.table == 0) pages.push_back(page(page_at(0, at.position)));
  }
  for (const Page& page : pages) put(page);
}

Manifest Forgery::manifest() const { return decode_manifest(stored.at({kHeaderTable, kManifestPosition}).content); }
void Forgery::put(const Manifest& manifest) { stored[{kHeaderTable, kManifestPosition}].content = encode(manifest); }
Provenance Forgery::provenance() const {
  return decode_provenance(stored.at({kHeaderTable, kProvenancePosition}).content);
}
void Forgery::put(const Provenance& provenance) {
  stored[{kHeaderTable, kProvenancePosition}].content = encode(provenance);
}

CodeDistance Forgery::distance() const { return CodeDistance(manifest().description); }

Page Forgery::page(PageId id) const {
  const Manifest m = manifest();
  const CodeDistance distance(m.description);
  static PageDecoder decoder;
  const auto other = [&](PageId of, PageDecoder::Content what) {
    const int table = what == PageDecoder::Content::slice ? kSliceTable : of.band;
    return std::span<const std::byte>(stored.at({table, curve_position(of)}).content);
  };
  return given_page(decoder.decode(id, m.description.extent, m.bands, distance, stored.at(key(id)).content, other),
                    distance);
}

void Forgery::put(const Page& page) {
  static PageEncoder encoder;  // its tables take long to make
  const TileId tile = tile_with(page.id);
  stored[key(page.id)].content =
      page.is_sliced() ? encoder.encode_in_slice(
                             page, digest_of(stored.at({kSliceTable, curve_position({1, tile.x, tile.y})}).content))
                       : encoder.encode(page, distance());
}

TileSummary Forgery::record(int x, int y) const {
  return decode_tile_summary(stored.at({kRecordTable, curve_position({1, x, y})}).content);
}
void Forgery::put(int x, int y, const TileSummary& record) {
  stored[{kRecordTable, curve_position({1, x, y})}] = {encode(record), record.entry.generation};
}

void Forgery::hide() {
  Manifest m = manifest();
  std::map<PageKey, ChildEntry> entries;
  for (int band = 0; band < m.bands; ++band) {
    std::vector<PageId> ids;
    for (const auto& [at, any] : stored) {
      if (at.table == band) ids.push_back(page_at(band, at.position));
    }
    for (const PageId id : ids) {
      Page told = page(id);
      ChildEntry entry = range_of(told, m.description.step);
      for (const ErrorCode error : told.errors) entry.largest = std::max(entry.largest, error);
      for (std::size_t i = 0; i < told.children.size(); ++i) {
        const auto below = entries.find(key(child_page(id, i)));
        told.children[i] = below == entries.end() ? ChildEntry{} : below->second;
        if (below != entries.end()) entry = joined(entry, below->second);
      }
      entry.generation = stored.at(key(id)).generation;
      entries[key(id)] = entry;
      put(told);
      if (band == 1 && stored.contains({kRecordTable, curve_position(id)})) {
        TileSummary summary = record(id.x, id.y);
        summary.entry = entry;
        put(id.x, id.y, summary);
      }
    }
  }
  m.top_generations.clear();
  for (const PageId id : pages_of_band(m.bands - 1, m.description.extent))
    m.top_generations.push_back(stored.at(key(id)).generation);
  put(m);
}

std::vector<double> Forgery::empty_slices() {
  const CodeDistance of = distance();
  std::vector<double> thresholds;
  TileSlice nothing;
  nothing.above = kNoSlice;
  for (auto& [key, slice] : stored) {
    if (key.table != kSliceTable) continue;
    const std::int32_t above = SliceCoder::threshold_of(slice.content);
    if (above != kNoSlice)
      thresholds.push_back(of.is_whole() ? of.metres(above / 8.0) : error_of(static_cast<ErrorCode>(above)));
    slice.content = SliceCoder().encode({0, 0}, manifest().description.extent, of, nothing);
  }
  return thresholds;
}

void Forgery::write(const std::filesystem::path& database) const {
  std::filesystem::remove(database);
  PageWriter writer(database);
  for (const auto& [at, page] : stored) writer.put(at, page.content, page.generation);
  writer.finish();
}

}  // namespace talus::support
