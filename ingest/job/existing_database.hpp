#pragma once
// The database that later tiles go into.

#include <filesystem>

#include "engine/page/manifest.hpp"
#include "ingest/job/panels.hpp"
#include "storage/page_store.hpp"

namespace talus {

/// A database as ingest sees it: samples on its grid. Several threads may ask for generations, one for samples.
class ExistingDatabase {
 public:
  /// fails  not_found, corrupt, unsupported
  explicit ExistingDatabase(const std::filesystem::path& database);

  [[nodiscard]] const Manifest& manifest() const { return manifest_; }
  [[nodiscard]] Provenance provenance() const;
  /// The generation of a page whose bytes are these; `otherwise` if it has others or does not exist.
  [[nodiscard]] std::uint32_t generation_of(PageKey key, std::span<const std::byte> content,
                                            std::uint32_t otherwise) const;
  /// Lays its samples under those of a window: where the window is void and the database is not.
  void fill(Window& window) const;

 private:
  ReadTxn txn_;
  Manifest manifest_;
};

}  // namespace talus
