#pragma once
// The database that an update starts from.

#include <filesystem>

#include "engine/page/manifest.hpp"
#include "ingest/job/panels.hpp"
#include "storage/page_store.hpp"

namespace talus {

/// The samples and generations of a database. Any number of threads may ask for generations, one for samples.
class ExistingDatabase {
 public:
  /// fails  not_found, corrupt, unsupported
  explicit ExistingDatabase(const std::filesystem::path& database);

  [[nodiscard]] const Manifest& manifest() const { return manifest_; }
  [[nodiscard]] Provenance provenance() const;
  /// The generation of a page that is stored with exactly these bytes; else `otherwise`.
  [[nodiscard]] std::uint32_t generation_of(PageKey key, std::span<const std::byte> content,
                                            std::uint32_t otherwise) const;
  /// Fills the void samples of a window with those of the database.
  void fill(Window& window) const;

 private:
  ReadTxn txn_;
  Manifest manifest_;
};

}  // namespace talus
