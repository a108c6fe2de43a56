#pragma once
// Rasters to databases.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/units.hpp"

namespace talus {

/// The grid of an existing database, for inputs that are to fit it.
struct Grid {
  GridMapping mapping;
  GridRect extent{{0, 0}, {-1, -1}};  ///< what it holds today; says on which side of the antimeridian new data belongs
  std::string crs_wkt;
  std::string vertical_unit = "metre";
  double metres_per_unit = 1;
  std::optional<HeightStep> step;  ///< codes must be in this one, as where a database is updated; empty: any will do
};
[[nodiscard]] Grid grid_of(const Description& description);

/// Rasters that write heights as the colours of a picture.
enum class ColourCode : std::uint8_t {
  none,         ///< colours are refused
  terrain_rgb,  ///< height = (red · 65536 + green · 256 + blue) · 0.1 − 10000 metres
  terrarium,    ///< height = (red · 256 + green + blue / 256) − 32768 metres
};

/// How inputs are read.
struct InputOptions {
  std::vector<std::string> allow_drivers;  ///< GDAL drivers that may open files, beyond those Talus trusts
  /// Folders whose files virtual rasters and symbolic links may lead to, beside the folder they lie in themselves.
  std::vector<std::filesystem::path> allow_outside;
  bool recursive = false;    ///< a folder stands for the rasters in its subfolders, too
  bool skip_broken = false;  ///< leave out inputs that cannot be opened, and say so; without it one is a failure
  int band = 0;              ///< the band that holds the heights, from 1; 0: the first that is not alpha
  std::string variable;      ///< of netCDF files with several; empty: the only one
  /// Values that mean no data in inputs that declare none. A sample type that cannot hold one has none of it.
  std::vector<double> nodata;
  ColourCode decode = ColourCode::none;
  std::string srs;            ///< the CRS of inputs, said from outside: EPSG:…, WKT or PROJ; empty: what they state
  std::string vertical_unit;  ///< of inputs, said from outside: metre, foot, us-survey-foot, km, dm, cm, mm
  /// Resample inputs that are not on it to this grid: any of CRS, cell size in its units (both or none), and
  /// method (near, bilinear, cubic, average). What is left out is the first input's, and bilinear.
  std::string target_srs;
  double target_dx = 0, target_dy = 0;
  std::string resampling;
  std::optional<Grid> grid;          ///< or to this one
  bool priority_resolution = false;  ///< where inputs overlap the one with smaller cells wins, not the later one
  Metres height_step{0};             ///< heights become multiples of this; 0: they stay as they are
};

struct IngestProgress {
  double fraction = 0;                         ///< of the whole work, 0 to 1
  const char* stage = "";                      ///< what is being done
  std::uint64_t samples = 0, all_samples = 0;  ///< settled so far, and in all
  double seconds = 0;                          ///< since the work began
  double seconds_left = 0;                     ///< at the present speed; less than 0: not known yet
  /// Of `samples`: those that were there when this work began; a rate leaves them out
  std::uint64_t samples_before = 0;
};

struct IngestOptions {
  bool overwrite = false;    ///< replace an existing database; without it one that exists is a failure
  bool resume = false;       ///< go on with what an interrupted ingest of the same inputs and options left
  double void_weight = 1.0;  ///< metres of error per metre of ground side where a triangle mixes data and void
  /// Keep only the vertices that an answer at this tolerance selects: no answer will be finer, and samples are not
  /// restored. 0: keep all.
  Metres finest_tolerance{0};
  ErrorMetric error_metric = ErrorMetric::vertical;
  int threads = 0;                                      ///< 0: one a core. The pages are the same for any number.
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;  ///< the process stays below it. The pages are the same.
  InputOptions inputs = {};
  /// Told now and then; may throw to end the work, which can then be resumed.
  std::function<void(const IngestProgress&)> progress = {};
};

/// What an update changes.
struct UpdateChange {
  std::uint64_t samples = 0;  ///< that hold something else afterwards: another height, or one where there was none
  std::uint64_t filled = 0;   ///< of these, those where there was none: void before, or beyond the database's rectangle
  double largest_m = 0;       ///< largest difference between a height before and after, in metres
  double x = 0, y = 0;        ///< where it is, in the CRS; meaningless if all samples were filled
  GridRect region{{0, 0}, {-1, -1}};  ///< the smallest rectangle around these samples; empty without any
};

struct IngestReport {
  Description description;
  std::uint64_t pages = 0;             ///< pages written
  std::uint64_t bytes = 0;             ///< size of the database file
  std::uint64_t tiles = 0;             ///< settled now, without those an interrupted ingest had left
  std::uint64_t samples = 0;           ///< of these tiles
  std::optional<UpdateChange> change;  ///< of an update
  std::uint64_t pages_read_back = 0;   ///< to measure triangles larger than a tile
  double seconds = 0;
  std::vector<std::string> notes;  ///< sentences on what was found in the inputs
};

/// What an ingest or an update would do.
struct IngestEstimate {
  Description description;             ///< without what takes a pass over the samples: minimum, maximum, void_samples
  std::uint64_t tiles = 0;             ///< to settle
  std::uint64_t bytes = 0;             ///< of the database, about
  double seconds = 0;                  ///< about
  int threads = 1;                     ///< as many as memory allows
  std::optional<UpdateChange> change;  ///< of an update
  std::vector<std::string> notes;
};

/// Makes a database from rasters.
///
/// inputs    local raster files GDAL reads: Byte, Int16, UInt16, Int32, UInt32, Float32 or Float64, one band each
///           (the first is taken), nodata and NaN are voids; heights within ±10⁶ metres
/// database  the file to make; work happens in `database`.part and is renamed at the end
/// fails     not_found, unsupported (driver, type, rotation, too many samples), invalid_argument (no band, all
///           void, a value that is no height, database exists, too little memory; with resume: an input or an option
///           is another one), corrupt (with resume: what was left is damaged), full, io (also: an input changed while
///           it was read, the database is write-protected). `database` is then as it was; what was done stays in
///           `unfinished_file(database)` and can be resumed, unless the inputs are at fault
/// cost      memory as `options` says; time linear, about 50 ns a sample and core; one pass over the samples, and one
///           over the bytes of all files before it, for their checksums
/// source    exact errors [P98 §5], saturation, levels of blocks [P98 §10], pages docs/format/v2.md
IngestReport ingest(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& options = {});
IngestReport ingest(const std::filesystem::path& input, const std::filesystem::path& database,
                    const IngestOptions& options = {});

/// Puts new or corrected data into a database: it then holds what an ingest of everything would have made, the new
/// inputs last. Only tiles whose samples differ, and what depends on them, are computed and written; the rest of the
/// file is copied. Readers keep what they opened; the new file takes the name in one step. Where no sample differs,
/// nothing is written and the generation stays.
///
/// inputs    as for ingest, brought onto the database's grid; a void does not cover data
/// database  where it is a symbolic link, the link stays and the file that it leads to is replaced; owner and mode stay
/// options   void_weight and error_metric are not looked at; overwrite: replace what an interrupted ingest
///           left; resume: what an interrupted update left is worth nothing, so it is computed anew with it or without
/// fails     as ingest; not_found, corrupt: the database, every byte of which is checked; unsupported: one that did not
///           keep all samples; io: another program replaced it meanwhile. It is then as it was
/// cost      reads the database and the inputs once, then as ingest for the tiles that change
IngestReport update(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                    const IngestOptions& options = {});

/// What ingest would do, from the inputs' headers and a few of their tiles. Writes nothing.
/// fails  as ingest; also where the folder of the database cannot be written or has too little room (full)
IngestEstimate estimate_ingest(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                               const IngestOptions& options = {});
/// What update would do. It reads all inputs and what the database holds beneath them, so `change` is exact.
/// fails  as update; also where the folder of the database cannot be written or has too little room (full)
IngestEstimate estimate_update(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& database,
                               const IngestOptions& options = {});

struct CompactReport {
  std::uint64_t bytes_before = 0, bytes = 0;  ///< of the file
  double seconds = 0;
};

/// Writes a database anew without the room that updates have left unused, and puts it in the old one's place in one
/// step. Answers, generation and identity stay; so does the file if nothing would be gained.
/// fails  not_found, corrupt, full, io: write-protected, or replaced by another program meanwhile. It is then as it was
/// cost   reads the file three times and writes what is used
CompactReport compact(const std::filesystem::path& database);

/// The file in which an ingest or an update of a database works, and which an interrupted ingest leaves.
[[nodiscard]] std::filesystem::path unfinished_file(const std::filesystem::path& database);

/// Inputs opened for comparison: the same samples `ingest` would take. Threads: one at a time.
///
/// inputs  raster files, folders of them, and "@list.txt", which names one a line
/// fails   as ingest does for its inputs
class Raster {
 public:
  explicit Raster(const std::filesystem::path& input);
  Raster(const std::vector<std::filesystem::path>& inputs, const InputOptions& options);
  ~Raster();
  Raster(Raster&&) noexcept;
  Raster& operator=(Raster&&) noexcept;

  [[nodiscard]] const Description& description() const;
  /// The samples of a rectangle, row 0 north, memory in proportion to it. Fails with io or invalid_argument.
  [[nodiscard]] SampleWindow read(GridRect part) const;

 private:
  struct Opened;
  std::unique_ptr<Opened> opened_;
};

/// Two CRS, as in Description::crs_wkt, that place the same numbers at the same places, heights included. Two empty
/// ones do.
[[nodiscard]] bool same_crs(const std::string& wkt, const std::string& other);

}  // namespace talus
