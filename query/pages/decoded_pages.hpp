#pragma once
// Pages for checks that look at neighbours: the last ones stay decoded, and damage is remembered instead of thrown.

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "query/pages/stored_pages.hpp"

namespace talus {

class DecodedPages {
 public:
  /// Memory: about 300 kB a page.
  explicit DecodedPages(const StoredPages& pages, std::size_t most = 160) : pages_(pages), most_(most) {}

  struct Found {
    std::shared_ptr<const Page> page;  ///< null: not stored, or damaged
    std::uint32_t generation = 0;
    std::string damage;  ///< what is wrong with it; empty: nothing
    [[nodiscard]] bool is_damaged() const { return !damage.empty(); }
  };
  /// fails  io
  [[nodiscard]] Found get(PageId id);

 private:
  using Key = std::pair<int, std::uint64_t>;
  using Kept = std::list<std::pair<Key, Found>>;
  [[nodiscard]] Found read(PageId id);

  const StoredPages& pages_;
  std::size_t most_;
  PageDecoder decoder_;
  Kept by_use_;  ///< last used first
  std::map<Key, Kept::iterator> places_;
};

}  // namespace talus
