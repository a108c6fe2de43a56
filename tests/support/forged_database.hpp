#pragma once
// Databases that were changed by somebody who knows the format: every checksum and the seal fit again.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/page/manifest.hpp"
#include "engine/page/page_codec.hpp"
#include "engine/tile/tile_summary.hpp"
#include "storage/page_store.hpp"

namespace talus::support {

class Forgery {
 public:
  /// Pages of band 0 take heights from the page above: a change of that would change them, too. In each page: they have
  /// these heights themselves, so that each page can be changed alone. Errors are then rounded up to codes once more.
  enum class Corners { as_stored, in_each_page };

  /// Everything a database holds.
  explicit Forgery(const std::filesystem::path& database, Corners corners = Corners::as_stored);

  struct Stored {
    std::vector<std::byte> content;
    std::uint32_t generation = 0;
  };
  std::map<PageKey, Stored> stored;  ///< what will be written

  [[nodiscard]] Manifest manifest() const;
  void put(const Manifest& manifest);
  [[nodiscard]] Provenance provenance() const;
  void put(const Provenance& provenance);
  [[nodiscard]] bool has(PageId id) const { return stored.contains(key(id)); }
  /// A page whose own vertices all have the codes of their errors, as the encoder takes it.
  [[nodiscard]] Page page(PageId id) const;
  void put(const Page& page);
  [[nodiscard]] TileSummary record(int x, int y) const;
  void put(int x, int y, const TileSummary& record);

  /// Makes the tables of pages below, the records' entries and the header's generations say again what is there: a
  /// change that shows nowhere else is hidden then.
  void hide();
  /// Makes all slices hold nothing, so that questions read pages. Returns the thresholds they had, in metres.
  std::vector<double> empty_slices();
  void write(const std::filesystem::path& database) const;

  [[nodiscard]] static PageKey key(PageId id) { return {id.band, curve_position(id)}; }

 private:
  [[nodiscard]] CodeDistance distance() const;
};

}  // namespace talus::support
