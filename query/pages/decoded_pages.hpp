#pragma once
// Decoded pages for checks that compare neighbours. The pages used last are kept; damage is reported, not thrown.

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
  /// most  pages kept, about 300 kB each
  explicit DecodedPages(const StoredPages& pages, std::size_t most = 160) : pages_(pages), most_(most) {}

  struct Found {
    std::shared_ptr<const Page> page;  ///< null: not stored, or damaged
    std::uint32_t generation = 0;
    std::string damage;  ///< what is wrong with the page; empty: the page is sound
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
  Kept by_use_;  ///< the page used last comes first
  std::map<Key, Kept::iterator> places_;
};

}  // namespace talus
