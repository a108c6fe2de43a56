#pragma once
// What a measurement of accuracy says: in words, as a table, as JSON, as pictures.

#include <optional>
#include <string>
#include <vector>

#include "app/terminal/report.hpp"
#include "talus/accuracy.hpp"

namespace talus::app {

/// What was asked on the command line, as far as reports name it.
struct AccuracyNames {
  std::string database;
  std::string truth;  ///< of the raster; empty: the database's own samples
  /// What the advised query took when it was asked from a standing start; nothing: not tried.
  std::optional<double> followed_seconds = {};
};

/// Whether a sample lies beyond what an answer promises: the errors that the database holds are wrong, or the raster is
/// another.
[[nodiscard]] bool is_beyond_bound(const AccuracyReport& report, const AccuracyPoint& point);

/// "For 10 ms you can have 3.2 m; for 1 m you pay 41 ms."
[[nodiscard]] std::string recommendation(const AccuracyReport& report);
/// The advised answer as arguments of `talus`, of several windows the typical one's; none where nothing is advised.
[[nodiscard]] std::vector<std::string> advised_query(const AccuracyReport& report, const AccuracyNames& names);
/// What a reader must know to take the figures for what they are.
[[nodiscard]] std::vector<std::string> caveats(const AccuracyReport& report, const AccuracyNames& names);
/// For people at a terminal; without the caveats.
[[nodiscard]] std::string accuracy_text(const AccuracyReport& report, const AccuracyNames& names);
[[nodiscard]] Json accuracy_json(const AccuracyReport& report, const AccuracyNames& names);
/// Curves and maps.
[[nodiscard]] std::string accuracy_svg(const AccuracyReport& report, const AccuracyNames& names);
/// All of it on one page that needs no other file.
[[nodiscard]] std::string accuracy_html(const AccuracyReport& report, const AccuracyNames& names);

}  // namespace talus::app
