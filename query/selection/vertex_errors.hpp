#pragma once
// The errors that selected an answer's vertices.

#include "query/pages/stored_pages.hpp"

namespace talus {

/// See Snapshot::errors.
[[nodiscard]] std::vector<double> vertex_errors(const StoredPages& pages, const RestrictedQuadtree& answer);

}  // namespace talus
