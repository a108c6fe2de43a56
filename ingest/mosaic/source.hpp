#pragma once
// All inputs as one raster on one grid.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/error/height_field.hpp"
#include "ingest/files/file_state.hpp"
#include "talus/description.hpp"
#include "talus/ingest.hpp"
#include "talus/units.hpp"

namespace talus {

/// An input, as info and reports show it.
struct InputFile {
  std::string name;  ///< without its folder
  std::string driver, type;
  std::int64_t cols = 0, rows = 0;
  std::uint64_t bytes = 0;
  std::vector<FileState> files;  ///< all files that it is read from, as they were before they were opened
  std::string void_value;        ///< "-32768", "nan", "mask", "alpha"; empty: nothing is void
  bool is_resampled = false;
  GridRect place{{0, 0}, {-1, -1}};  ///< on the common grid
  std::vector<std::string> notes;
};

/// The samples of a rectangle.
struct Window {
  GridRect region{{0, 0}, {-1, -1}};
  Codes codes;                      ///< row by row from the north; 0 where void
  std::vector<std::uint8_t> valid;  ///< 1: valid; empty: all are valid
};

/// Differences where valid samples of inputs overlap.
struct SeamReport {
  std::uint64_t compared = 0;     ///< samples that were compared
  std::uint64_t different = 0;    ///< samples with different heights
  double largest_m = 0;           ///< largest difference
  GridPoint at;                   ///< place of the largest; if several, the northernmost, then the westernmost
  double x = 0, y = 0;            ///< the same place in the CRS
  std::string covered, covering;  ///< the file below and the file whose height was used
};
/// Joins the reports of samples that do not overlap.
[[nodiscard]] SeamReport joined(const SeamReport& a, const SeamReport& b);

/// Rasters on one grid as one raster. Where they overlap, the last named one is on top, or the one with smaller cells;
/// a void sample hides nothing. If the options name a target grid, other inputs are resampled to it, and every bound
/// refers to the resampled heights. Sample (0, 0) is the north-west sample of the first input, or the grid's.
///
/// Keeps a few files open, however many inputs there are. One thread at a time; clone for another.
class Source {
 public:
  /// Reads the header of every input once.
  /// fails  not_found, io; unsupported: see raster_guard.hpp, sample types, rotation, units, CRSs and grids that do
  ///        not fit; invalid_argument: no input, impossible sizes or options
  Source(const std::vector<std::filesystem::path>& inputs, const InputOptions& options);
  ~Source();
  Source(Source&&) noexcept;
  Source& operator=(Source&&) noexcept;

  /// The same inputs, with open files and seams of its own. Reads no header again.
  [[nodiscard]] Source clone() const;

  /// Minimum, maximum and void_samples are 0: they need a pass over the samples.
  [[nodiscard]] const Description& description() const;
  [[nodiscard]] const std::vector<InputFile>& inputs() const;
  /// Sentences for the user on what was reversed, assumed or left out.
  [[nodiscard]] const std::vector<std::string>& notes() const;

  /// Reads a rectangle of the extent. Seams are compared in `own` only, so that overlapping windows compare each sample
  /// once.
  /// fails  invalid_argument: beyond the extent, or a sample that is not a height; io: names the file and rows
  /// cost   reads each input once; memory: the result, GDAL's cache, and a copy where inputs overlap
  [[nodiscard]] Window read(GridRect part, GridRect own) const;
  /// The same, into a window that may have been used before. Memory of the same size is used again.
  void read_into(Window& window, GridRect part, GridRect own) const;
  [[nodiscard]] Window read(GridRect part) const { return read(part, GridRect{{0, 0}, {-1, -1}}); }

  /// Whether an input has samples in `part`. If none does, all of it is void.
  [[nodiscard]] bool touches(GridRect part) const;
  /// The largest block that GDAL reads as a whole, in any input.
  [[nodiscard]] std::uint64_t block_bytes() const;

  /// Differences found by the reads so far.
  [[nodiscard]] SeamReport seams() const;
  /// Sentences on heights that may mean no data, judged by the reads so far and the range of all heights.
  [[nodiscard]] std::vector<std::string> doubts(double minimum, double maximum) const;

  /// The files of an input as they are now. Fails as the constructor does.
  [[nodiscard]] std::vector<FileState> files_now(std::size_t input) const;

 private:
  struct Plan;
  struct Reader;
  Source();

  std::shared_ptr<const Plan> plan_;
  std::unique_ptr<Reader> reader_;
};

}  // namespace talus
