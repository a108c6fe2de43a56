#pragma once
// The errors that selected an answer's vertices.

#include "query/pages/stored_pages.hpp"

namespace talus {

/// See errors_of.
[[nodiscard]] std::vector<double> vertex_errors(const StoredPages& pages, const RestrictedQuadtree& answer);

}  // namespace talus
