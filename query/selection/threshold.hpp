#pragma once
// The vertices of a page that a tolerance selects, and the bound that follows from those that it leaves out.

#include <algorithm>
#include <span>
#include <vector>

#include "engine/page/page_codec.hpp"
#include "query/pages/stored_pages.hpp"

namespace talus {

/// A tolerance as a code for stored errors, and as an exact distance for implied errors.
///
/// Errors count as whole eighths of a height code, or as codes (Page::counted_error). So a tolerance counts as the
/// largest number of eighths, or the largest code, within it, and all pages and slices select the same vertices.
class Threshold {
 public:
  /// tolerance_m  in metres, less the loss
  Threshold(double tolerance_m, const CodeDistance& distance);

  /// Whether sample i is an own vertex of the page with an error above the tolerance.
  [[nodiscard]] bool operator()(const Page& page, std::size_t i) const {
    if (page.is_dense) return page.has_distance(i) ? page.dense_error(i) > eighths_ : page.code(i) > code_;
    if (page.errors[i] > code_) return true;
    if (!page.eighths.empty()) return page.eighths[i] > eighths_;
    return !page.distances.empty() && page.distances[i] > distance_;
  }
  /// Whether a page with this largest error may have such a vertex.
  [[nodiscard]] bool operator()(ErrorCode largest) const { return largest > code_; }

  [[nodiscard]] ErrorCode code() const { return code_; }
  [[nodiscard]] std::int32_t eighths() const { return eighths_; }  ///< of a height code; -1: the tolerance is below 0
  [[nodiscard]] double distance() const { return distance_; }      ///< in height codes
  /// What it counts as, to compare with Page::counted_error; -1: the tolerance is below 0.
  [[nodiscard]] std::int32_t counted() const { return counted_; }

 private:
  ErrorCode code_;
  double distance_ = -1;
  std::int32_t eighths_ = -1, counted_ = -1;
};

/// The largest errors of the vertices that an answer leaves out.
struct LargestAbsent {
  ErrorCode code = 0;
  double distance = -1;  ///< the largest exact error, in height codes; below 0: none

  void take(const Page& page, std::size_t i) {
    if (page.has_distance(i)) {
      distance = std::max(distance, page.distance_of(i));
    } else {
      code = std::max(code, page.code(i));
    }
  }
  /// An error, as what it counts as.
  void take(std::int32_t counted, const CodeDistance& of) {
    if (of.is_whole()) {
      distance = std::max(distance, counted / 8.0);
    } else {
      code = std::max(code, static_cast<ErrorCode>(counted));
    }
  }
  void take(const LargestAbsent& others) {
    code = std::max(code, others.code);
    distance = std::max(distance, others.distance);
  }
};

/// Collects RestrictedQuadtree::level_errors.
class LargestByLevel {
 public:
  explicit LargestByLevel(GridRect extent);
  /// The error of a vertex at p, as what it counts as.
  void take(std::int32_t counted, GridPoint p, const CodeDistance& of) { level_of(p).take(counted, of); }
  /// The same for sample i of a page; an error of kMostEighths as it is.
  void take(const Page& page, std::size_t i, GridPoint p, const CodeDistance& of) {
    const std::int32_t counted = page.counted_error(i, of);
    counted == kMostEighths ? level_of(p).take(page, i) : level_of(p).take(counted, of);
  }
  /// The error of a vertex of spacing 2 to the power `height` in eighths of a height code; -1: none.
  void take(int height, std::int16_t eighths, const CodeDistance& of) {
    LargestAbsent& level = levels_[std::min<std::size_t>(static_cast<std::size_t>(height), levels_.size() - 1)];
    if (eighths >= 0) level.take(of.is_whole() ? eighths : error_code(of.metres(eighths / 8.0)), of);
  }
  void take(const LargestByLevel& others);
  [[nodiscard]] std::vector<double> metres(const StoredPages& pages) const;

 private:
  [[nodiscard]] LargestAbsent& level_of(GridPoint p) {
    return levels_[std::min<std::size_t>(static_cast<std::size_t>(height_in_tree(p)), levels_.size() - 1)];
  }
  std::vector<LargestAbsent> levels_;  ///< largest errors of the answer's vertices, by log2 of the spacing
};

/// The bound of an answer without these vertices: no sample under its surface is farther from it.
///
/// tolerance_m  the tolerance that left them out; infinite if it varied
[[nodiscard]] Metres bound_of(const StoredPages& pages, const LargestAbsent& absent, double tolerance_m);

}  // namespace talus
