#pragma once
// What stands behind a Snapshot.

#include <mutex>

#include "query/range_query.hpp"
#include "query/stored_pages.hpp"
#include "query/surface.hpp"

namespace talus {

struct Snapshot::View {
  explicit View(StoredPages stored) : pages(std::move(stored)) {}

  StoredPages pages;

  /// Made when it is first asked for.
  const ExtentBorder& border() {
    std::call_once(border_made_, [this] { border_ = ExtentBorder(pages.manifest().description.extent); });
    return border_;
  }

 private:
  std::once_flag border_made_;
  ExtentBorder border_;
};

[[nodiscard]] const StoredPages& pages_of(const Snapshot& snapshot);

}  // namespace talus
