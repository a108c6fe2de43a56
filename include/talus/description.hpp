#pragma once
// Description: what Talus knows of a raster or a database.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "talus/units.hpp"

namespace talus {

/// The direction of a vertex's error: vertical, or at right angles to the triangle [P98 §5], which is never larger. Cells
/// count as large as on the row of the vertex.
enum class ErrorMetric : std::uint8_t { vertical, perpendicular };

/// Names as in manifests and on command lines.
[[nodiscard]] const char* name_of(ErrorMetric metric);
[[nodiscard]] std::optional<ErrorMetric> error_metric_named(std::string_view name);

/// How a stored height code becomes the source's value, bit for bit:
/// value = code · scale / divisor + offset, in this order, in double.
/// Float sources without a common step have scale = divisor = 1, offset = 0 and integer = false.
struct HeightStep {
  double scale = 1, divisor = 1, offset = 0;
  bool integer = true;  ///< codes are whole numbers; false: a code is the source's own float
  friend bool operator==(const HeightStep&, const HeightStep&) = default;
  [[nodiscard]] double value(double code) const {
    return integer ? code * scale / divisor + offset : code;  // a float keeps its sign of zero
  }
};

/// Facts about a coordinate reference system. Ingest reads them from PROJ once and stores them, so reading needs no
/// PROJ. The defaults mean no CRS: coordinates are metres.
struct CrsFacts {
  std::string name;                              ///< "WGS 84 / UTM zone 32N"; empty: no CRS
  int epsg = 0;                                  ///< EPSG number; 0: none
  bool is_geographic = false;                    ///< x is the longitude, y the latitude
  double metres_per_unit = 1;                    ///< unit of x and y, unless geographic
  double degrees_per_unit = 1;                   ///< unit of x and y, if geographic
  double equatorial_radius = 0, flattening = 0;  ///< the ellipsoid, if geographic; radius in metres
  friend bool operator==(const CrsFacts&, const CrsFacts&) = default;
};

struct Description {
  GridRect extent{{0, 0}, {-1, -1}};  ///< the rectangle of all samples
  GridMapping mapping;
  std::string crs_wkt;         ///< empty: none, cell sizes count as metres
  CrsFacts crs;                ///< facts from crs_wkt
  std::string source_name;     ///< file name of the source, without its folder
  std::string source_type;     ///< GDAL's name of the sample type: Int16, Float32 …
  std::string vertical_unit;   ///< as the source states it; "metre" if it states none
  double metres_per_unit = 1;  ///< metres in one vertical unit
  HeightStep step;
  double minimum_height = 0, maximum_height = 0;  ///< of valid samples, in the vertical unit
  std::uint64_t void_samples = 0;
  double void_weight = 1;  ///< see IngestOptions
  Metres lossy;            ///< the largest distance between stored and source heights; part of every bound
  /// The tolerance of the finest answer: only its vertices were kept. 0: all samples were kept.
  Metres finest_tolerance;
  ErrorMetric error_metric = ErrorMetric::vertical;
  /// Vertices with an error within this were not kept. 0: all were kept.
  [[nodiscard]] Metres kept_above() const { return finest_tolerance > lossy ? finest_tolerance - lossy : Metres{0}; }
};

/// One input file of a database.
struct SourceFile {
  std::string name;  ///< without its folder
  std::string driver, type;
  std::int64_t cols = 0, rows = 0;
  std::uint64_t bytes = 0, checksum = 0;  ///< size and XXH3 (64 bits) of the file
};

/// A database and its state. Two files with the same identity have the same inputs and options, and the same answers.
struct Identity {
  std::uint64_t content = 0;     ///< XXH3 of manifest and provenance (with the inputs' checksums); 0: not known
  std::uint32_t generation = 0;  ///< number of updates
  friend bool operator==(const Identity&, const Identity&) = default;
};

/// How a database was made.
struct Provenance {
  Identity identity;                ///< the state that was read; not stored here
  std::vector<SourceFile> sources;  ///< in the order of ingest
  std::string made_by;              ///< program, version and the options that change the content
  std::uint32_t generation = 0;     ///< number of updates
  /// (tolerance in metres, vertices with an error above it), rising tolerance. It counts vertices with a spacing below
  /// 64, which are all but one in 4096, without those that only a border needs.
  std::vector<std::pair<double, std::uint64_t>> vertices_above;
};

/// Samples of a rectangle, row by row from the north.
struct SampleWindow {
  GridRect region{{0, 0}, {-1, -1}};
  std::vector<double> values;       ///< in the vertical unit; unspecified where void
  std::vector<std::uint8_t> valid;  ///< 1: valid, 0: void

  [[nodiscard]] std::size_t index(GridPoint p) const {
    return static_cast<std::size_t>((std::int64_t{p.row} - region.first.row) * region.cols() +
                                    (std::int64_t{p.col} - region.first.col));
  }
};

}  // namespace talus
