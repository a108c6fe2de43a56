#pragma once
// From heights and errors to pages.

#include <functional>

#include "engine/manifest.hpp"
#include "engine/page_codec.hpp"
#include "engine/vertex_error.hpp"

namespace talus {

struct PackInput {
  const Manifest& manifest;
  const ErrorInput& errors_from;        ///< heights, voids
  const LevelGrid<ErrorCode>& errors;   ///< saturated
  std::span<const std::uint8_t> valid;  ///< empty: all data
};

/// Hands out every page that holds data, band by band from the finest, each in curve order, so that what
/// a page must know of those below it is there when its turn comes.
void pack(const PackInput& input, const std::function<void(const Page&)>& take);

}  // namespace talus
