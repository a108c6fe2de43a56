#pragma once
// Ingest: makes and updates databases from rasters.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/units.hpp"

namespace talus {

/// The grid of an existing database, for inputs that must fit it.
struct Grid {
  GridMapping mapping;
  GridRect extent{{0, 0}, {-1, -1}};  ///< today's extent; decides on which side of the antimeridian new data belongs
  std::string crs_wkt;
  std::string vertical_unit = "metre";
  double metres_per_unit = 1;
  std::optional<HeightStep> step;  ///< required height step, as for an update; empty: any
};
[[nodiscard]] Grid grid_of(const Description& description);

/// Pictures whose colours are heights.
enum class ColourCode : std::uint8_t {
  none,         ///< colours are refused
  terrain_rgb,  ///< height = (red · 65536 + green · 256 + blue) · 0.1 − 10000 metres
  terrarium,    ///< height = (red · 256 + green + blue / 256) − 32768 metres
};

/// Units of heights. A foot is the international one.
enum class VerticalUnit : std::uint8_t { metre, kilometre, decimetre, centimetre, millimetre, foot, us_survey_foot };

enum class Resampling : std::uint8_t { bilinear, near, cubic, average };

/// Names as on command lines: "us-survey-foot", "near".
[[nodiscard]] const char* name_of(VerticalUnit unit);
[[nodiscard]] const char* name_of(Resampling resampling);

/// How inputs are read.
struct InputOptions {
  std::vector<std::string> allow_drivers;  ///< GDAL drivers to use besides those that Talus trusts
  /// Folders that virtual rasters and symbolic links may lead to, besides their own folder.
  std::vector<std::filesystem::path> allow_outside;
  bool recursive = false;    ///< read the rasters in subfolders of a folder too
  bool skip_broken = false;  ///< leave out inputs that cannot be opened, with a note; false: they are a failure
  int band = 0;              ///< band with the heights, from 1; 0: the first that is not alpha
  std::string variable;      ///< netCDF variable; empty: the only one
  /// Values that mean void, for inputs that declare none. Ignored for sample types that cannot hold them.
  std::vector<double> nodata;
  ColourCode decode = ColourCode::none;
  std::string srs;                            ///< CRS of the inputs: EPSG:…, WKT or PROJ; empty: as they state
  std::optional<VerticalUnit> vertical_unit;  ///< unit of the inputs' heights; empty: as they state
  /// Resample inputs to this grid if they are not on it: CRS, cell size in its units (both or none), and method.
  /// Default: CRS and cell size of the first input, bilinear.
  std::string target_srs;
  double target_dx = 0, target_dy = 0;
  std::optional<Resampling> resampling;
  std::optional<Grid> grid;          ///< or resample to this grid
  bool priority_resolution = false;  ///< in overlaps the input with smaller cells counts; false: the later one
  Metres height_step{0};             ///< round heights to multiples of this; 0: keep them
};

struct IngestProgress {
  double fraction = 0;                         ///< share of the whole work, 0 to 1
  const char* stage = "";                      ///< name of the present stage
  std::uint64_t samples = 0, all_samples = 0;  ///< finished so far, and in all
  double seconds = 0;                          ///< since the work began
  double seconds_left = 0;                     ///< at the present speed; below 0: not known yet
  /// Part of `samples` that was finished before this work began. Leave it out of a rate.
  std::uint64_t samples_before = 0;
};

struct IngestOptions {
  bool overwrite = false;    ///< replace an existing database; false: that is a failure
  bool resume = false;       ///< continue an interrupted ingest of the same inputs with the same options
  double void_weight = 1.0;  ///< metres of error a metre of ground side, for a triangle with data and voids
  /// Keep only the vertices of the answer at this tolerance. Finer answers and the samples are lost. 0: keep all.
  Metres finest_tolerance{0};
  ErrorMetric error_metric = ErrorMetric::vertical;
  int threads = 0;                                      ///< 0: one a core. The pages do not depend on it
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;  ///< most memory of the process. The pages do not depend on it
  InputOptions inputs = {};
  /// Called now and then. May throw to stop the work, which can then be resumed.
  std::function<void(const IngestProgress&)> progress = {};
};

/// How an update changes a database.
struct UpdateChange {
  std::uint64_t samples = 0;          ///< changed samples, filled ones included
  std::uint64_t filled = 0;           ///< samples that had no height before: void, or outside the extent
  Metres largest;                     ///< largest change of a height
  double x = 0, y = 0;                ///< its position in the CRS; meaningless if all samples were filled
  GridRect region{{0, 0}, {-1, -1}};  ///< smallest rectangle with all changes; empty: none
};

struct IngestReport {
  Description description;
  std::uint64_t pages = 0;             ///< pages written
  std::uint64_t bytes = 0;             ///< size of the database file
  std::uint64_t tiles = 0;             ///< tiles computed, without those of an interrupted ingest
  std::uint64_t samples = 0;           ///< samples of these tiles
  std::optional<UpdateChange> change;  ///< for an update
  std::uint64_t pages_read_back = 0;   ///< pages read again for triangles larger than a tile
  double seconds = 0;
  std::vector<std::string> notes;  ///< sentences about the inputs
};

/// What an ingest or an update would do.
struct IngestEstimate {
  Description description;             ///< without minimum, maximum and void_samples, which need every sample
  std::uint64_t tiles = 0;             ///< tiles to compute
  std::uint64_t bytes = 0;             ///< approximate size of the database
  double seconds = 0;                  ///< approximate time
  int threads = 1;                     ///< as many as the memory allows
  std::optional<UpdateChange> change;  ///< for an update
  std::vector<std::string> notes;
};

/// Makes a database from rasters.
///
/// inputs    local raster files that GDAL reads: Byte, Int16, UInt16, Int32, UInt32, Float32 or Float64; one band
///           counts. Nodata and NaN are voids; heights lie within ±10⁶ metres
/// database  the file to make. Work happens in unfinished_file(database), which is renamed at the end
/// fails     not_found; unsupported: driver, type, rotation, too many samples; invalid_argument: no band, only voids, a
///           value that is not a height, the database exists, too little memory, (resume) other inputs or options;
///           corrupt: (resume) the unfinished file is damaged; full; io: also an input that changed meanwhile, or a
///           write-protected database. `database` does not change; the unfinished file stays for resume, unless an
///           input is at fault
/// cost      memory: options.memory_bytes. Time: linear, about 50 ns a sample and core. Reads the samples once, and
///           before that all bytes of the files once for their checksums
/// source    exact errors [P98 §5], saturation, levels of blocks [P98 §10], pages docs/format/v3.md
IngestReport ingest(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& options = {});
IngestReport ingest(const std::filesystem::path& input, const std::filesystem::path& database,
                    const IngestOptions& options = {});
inline IngestReport ingest(std::initializer_list<std::filesystem::path> inputs, const std::filesystem::path& database,
                           const IngestOptions& options = {}) {
  return ingest(std::vector<std::filesystem::path>(inputs), database, options);
}

/// Adds new or corrected data to a database. The result equals an ingest of all inputs, the new ones last. Only tiles
/// with changed samples, and what depends on them, are computed; the rest is copied. Open databases keep the old file;
/// the new one replaces it in one step. If no sample changes, nothing is written.
///
/// inputs    as for ingest, resampled to the database's grid; a void does not replace data
/// database  if it is a symbolic link, the file that it leads to is replaced; owner and mode stay
/// options   void_weight and error_metric are ignored; overwrite: replace an unfinished file; resume: an
///           interrupted update always starts again
/// fails     as ingest; not_found; corrupt: the database, of which every byte is checked; unsupported: it did not keep
///           all samples; io: another program replaced it meanwhile. `database` does not change
/// cost      reads the database and the inputs once, then as ingest for the changed tiles
IngestReport update(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& options = {});

/// What ingest would do, from the inputs' headers and some of their tiles. Writes nothing.
/// fails  as ingest; also full or io: the database's folder has too little space or cannot be written
IngestEstimate estimate_ingest(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                               const IngestOptions& options = {});
/// What update would do. It reads all inputs and the samples under them, so `change` is exact. Writes nothing.
/// fails  as update; also full or io: the database's folder has too little space or cannot be written
IngestEstimate estimate_update(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                               const IngestOptions& options = {});

struct CompactReport {
  std::uint64_t bytes_before = 0, bytes = 0;  ///< size of the file
  double seconds = 0;
};

/// Removes the unused space that updates left in a database. The new file replaces the old one in one step. Answers,
/// generation and identity stay. If there is nothing to gain, the file stays.
/// fails  not_found, corrupt, full; io: also write-protected, or replaced meanwhile. The file does not change
/// cost   reads the file three times and writes the used part
CompactReport compact(const std::filesystem::path& database);

/// The file that an ingest or update works in. An interrupted ingest leaves it behind.
[[nodiscard]] std::filesystem::path unfinished_file(const std::filesystem::path& database);

/// Inputs opened as rasters, with the same samples as in `ingest`. Threads: one at a time.
///
/// inputs  raster files, folders of them, and "@list.txt" (a list of names, one a line)
/// fails   as ingest for its inputs
class Raster {
 public:
  explicit Raster(const std::filesystem::path& input);
  Raster(const std::vector<std::filesystem::path>& inputs, const InputOptions& options);
  ~Raster();
  Raster(Raster&&) noexcept;
  Raster& operator=(Raster&&) noexcept;

  [[nodiscard]] const Description& description() const;
  /// The samples of a rectangle, row 0 north. Memory: linear in its samples. fails  io, invalid_argument
  [[nodiscard]] SampleWindow read(GridRect part) const;

 private:
  struct Opened;
  std::unique_ptr<Opened> opened_;
};

/// Whether two CRS (as in Description::crs_wkt) give every position the same coordinates, heights included. Two empty
/// ones do.
[[nodiscard]] bool same_crs(const std::string& wkt, const std::string& other);

}  // namespace talus
