#pragma once
// What a raster or a database says of itself.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "talus/units.hpp"

namespace talus {

/// The direction of a vertex's error: along the vertical, or at right angles to the triangle [P98 §5], which is never
/// more. Cells are then as large as on the row of the vertex.
enum class ErrorMetric : std::uint8_t { vertical, perpendicular };

/// As they stand in manifests and on command lines.
[[nodiscard]] const char* name_of(ErrorMetric metric);
[[nodiscard]] std::optional<ErrorMetric> error_metric_named(std::string_view name);

/// How stored height codes become the source's values, bit for bit:
/// value = code · scale / divisor + offset, in that order, in double.
/// Sources in floats that sit on no step have scale = divisor = 1, offset = 0 and integer = false.
struct HeightStep {
  double scale = 1, divisor = 1, offset = 0;
  bool integer = true;  ///< codes are whole numbers; otherwise a code is the source's own float
  friend bool operator==(const HeightStep&, const HeightStep&) = default;
  [[nodiscard]] double value(double code) const {
    return integer ? code * scale / divisor + offset : code;  // a float keeps its sign of zero
  }
};

/// What Talus needs to know of a coordinate reference system. Ingest asks PROJ once and writes it down, so that a
/// program that only reads needs no library for it. The defaults describe no CRS: coordinates are metres.
struct CrsFacts {
  std::string name;                              ///< "WGS 84 / UTM zone 32N"; empty: no CRS
  int epsg = 0;                                  ///< its number in the EPSG registry; 0: it has none
  bool is_geographic = false;                    ///< x is the longitude, y the latitude
  double metres_per_unit = 1;                    ///< of x and y, unless geographic
  double degrees_per_unit = 1;                   ///< of x and y, if geographic
  double equatorial_radius = 0, flattening = 0;  ///< of the ellipsoid, if geographic; the radius in metres
  friend bool operator==(const CrsFacts&, const CrsFacts&) = default;
};

struct Description {
  GridRect extent{{0, 0}, {-1, -1}};  ///< all samples, outermost rows and columns included
  GridMapping mapping;
  std::string crs_wkt;         ///< empty: none, cells count as metres
  CrsFacts crs;                ///< what crs_wkt says, as far as Talus needs it
  std::string source_name;     ///< file name of the source, without its folder
  std::string source_type;     ///< GDAL's name of the sample type: Int16, Float32 …
  std::string vertical_unit;   ///< as the source says it; "metre" where it says nothing
  double metres_per_unit = 1;  ///< of the vertical unit
  HeightStep step;
  double minimum = 0, maximum = 0;  ///< heights of valid samples, in the vertical unit
  std::uint64_t void_samples = 0;
  double void_weight = 1;   ///< see IngestOptions
  double lossy_metres = 0;  ///< how far stored heights may lie from the source's; part of every answer's bound
  /// The tolerance of the finest answer: vertices that it does not select were not kept. 0: all samples were.
  double finest_tolerance = 0;
  ErrorMetric error_metric = ErrorMetric::vertical;
  /// Metres: heights of vertices whose error is not above were not kept. 0: all were.
  [[nodiscard]] double kept_above() const {
    return finest_tolerance > lossy_metres ? finest_tolerance - lossy_metres : 0;
  }
};

/// One file that a database was made from.
struct SourceFile {
  std::string name;  ///< without its folder
  std::string driver, type;
  std::int64_t cols = 0, rows = 0;
  std::uint64_t bytes = 0, checksum = 0;  ///< of the file: size and XXH3 of 64 bits
};

/// Which database, and which state of it. Two files with one identity were made of the same inputs with the same
/// options, so that they give the same answers.
struct Identity {
  std::uint64_t content = 0;     ///< XXH3 over manifest and provenance, which hold the inputs' checksums; 0: not known
  std::uint32_t generation = 0;  ///< updates so far
  friend bool operator==(const Identity&, const Identity&) = default;
};

/// How a database came about.
struct Provenance {
  Identity identity;                ///< the state that was read; not part of what is stored
  std::vector<SourceFile> sources;  ///< in the order in which they were laid
  std::string made_by;              ///< program, version and options that matter to the content
  std::uint32_t generation = 0;     ///< updates so far
  /// How many vertices of spacing below 64, which are all but one in 4096, a tolerance selects before any border:
  /// (tolerance in metres, vertices), rising tolerance.
  std::vector<std::pair<double, std::uint64_t>> vertices_above;
};

/// Samples of a rectangle, row by row from the north.
struct SampleWindow {
  GridRect region{{0, 0}, {-1, -1}};
  std::vector<double> values;       ///< in the vertical unit; unspecified where void
  std::vector<std::uint8_t> valid;  ///< 1 where the sample is data

  [[nodiscard]] std::size_t index(GridPoint p) const {
    return static_cast<std::size_t>((std::int64_t{p.row} - region.first.row) * region.cols() +
                                    (std::int64_t{p.col} - region.first.col));
  }
};

}  // namespace talus
