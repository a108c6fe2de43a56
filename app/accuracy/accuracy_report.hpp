#pragma once
// A report on accuracy: words, table, JSON and pictures.

#include <optional>
#include <string>
#include <vector>

#include "app/terminal/report.hpp"
#include "talus/accuracy.hpp"

namespace talus::app {

/// Names for the report.
struct AccuracyNames {
  std::string database;
  std::string truth;  ///< name of the raster; empty: the database's own samples
  /// Time of the recommended query in a new process; empty: not tried.
  std::optional<double> followed_seconds = {};
};

/// Whether a sample lies beyond the bound of an answer. Then the errors in the database are wrong, or the raster is
/// another one.
[[nodiscard]] bool is_beyond_bound(const AccuracyReport& report, const AccuracyPoint& point);

/// "For 10 ms you can have 3.2 m; 1 m takes 41 ms."
[[nodiscard]] std::string recommendation(const AccuracyReport& report);
/// The recommended query as arguments of `talus`, for a typical window; empty if nothing is recommended.
[[nodiscard]] std::vector<std::string> advised_query(const AccuracyReport& report, const AccuracyNames& names);
/// What a reader must know about the figures.
[[nodiscard]] std::vector<std::string> caveats(const AccuracyReport& report, const AccuracyNames& names);
/// For people at a terminal; without the caveats.
[[nodiscard]] std::string accuracy_text(const AccuracyReport& report, const AccuracyNames& names);
[[nodiscard]] Json accuracy_json(const AccuracyReport& report, const AccuracyNames& names);
/// A picture of curves and maps.
[[nodiscard]] std::string accuracy_svg(const AccuracyReport& report, const AccuracyNames& names);
/// One page that needs no other file.
[[nodiscard]] std::string accuracy_html(const AccuracyReport& report, const AccuracyNames& names);

}  // namespace talus::app
