#pragma once
// What a database holds, page by page.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "storage/page_store.hpp"

namespace talus::support {

/// Every page and record with its bytes, the header left out: two databases with the same are the same.
inline std::map<PageKey, std::string> pages_of(const std::filesystem::path& database) {
  std::map<PageKey, std::string> pages;
  const ReadTxn txn(PageStore::open(database));
  for (int table = 0; table <= kSliceTable; ++table) {
    txn.for_each(table, [&](std::uint64_t position) {
      const auto content = txn.find({table, position})->content;
      pages[{table, position}] = {reinterpret_cast<const char*>(content.data()), content.size()};
    });
  }
  return pages;
}

}  // namespace talus::support
