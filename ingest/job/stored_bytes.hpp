#pragma once
// Pages that a file already has, for a decoder that needs the page above.

#include "engine/page/page_codec.hpp"
#include "storage/page_store.hpp"

namespace talus {

/// The content of pages and slices of a file. The transaction must live longer.
[[nodiscard]] inline PageDecoder::BytesOf content_in(const ReadTxn& txn) {
  return [&txn](PageId id, PageDecoder::Content what) {
    const int table = what == PageDecoder::Content::slice ? kSliceTable : id.band;
    const auto stored = txn.find({table, curve_position(id)});
    return stored ? stored->content : std::span<const std::byte>();
  };
}

}  // namespace talus
