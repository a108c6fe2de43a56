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

/// One input, as info and reports show it.
struct InputFile {
  std::string name;  ///< without its folder
  std::string driver, type;
  std::int64_t cols = 0, rows = 0;
  std::uint64_t bytes = 0;
  std::vector<FileState> files;  ///< all that it is read from, as they were before they were opened
  std::string void_value;        ///< "-32768", "nan", "mask", "alpha"; empty: nothing is void
  bool is_resampled = false;
  GridRect place{{0, 0}, {-1, -1}};  ///< on the common grid
  std::vector<std::string> notes;
};

/// Samples of a rectangle.
struct Window {
  GridRect region{{0, 0}, {-1, -1}};
  Codes codes;                      ///< row by row from the north; 0 where void
  std::vector<std::uint8_t> valid;  ///< 1 where a sample is data; empty: all are
};

/// Where inputs overlap and both have data.
struct SeamReport {
  std::uint64_t compared = 0;     ///< samples
  std::uint64_t different = 0;    ///< of these
  double largest_m = 0;           ///< difference
  GridPoint at;                   ///< of the largest; of several the northernmost, of these the westernmost
  double x = 0, y = 0;            ///< the same place in the CRS
  std::string covered, covering;  ///< the files: the one that lost there, the one whose height was taken
};
/// Of two sets of samples that do not overlap.
[[nodiscard]] SeamReport joined(const SeamReport& a, const SeamReport& b);

/// Rasters on one grid become one raster; where they overlap, the later named one wins, or the one with smaller
/// cells; a void never covers data. Where the options name a target grid, inputs that are not on it are
/// resampled, and the resampled heights are what every promise is about. Sample (0, 0) is the north-west sample of
/// the first input, or the grid's.
///
/// Holds a few open files at a time, however many inputs there are. One thread at a time; a clone serves another.
class Source {
 public:
  /// Looks at every input once.
  /// fails  not_found, io; unsupported: see raster_guard.hpp, sample types, rotation, units, CRSs and grids that do
  ///        not go together; invalid_argument: nothing to read, sizes and options that make no sense
  Source(const std::vector<std::filesystem::path>& inputs, const InputOptions& options);
  ~Source();
  Source(Source&&) noexcept;
  Source& operator=(Source&&) noexcept;

  /// The same inputs with open files and seams of its own: looks at no file again.
  [[nodiscard]] Source clone() const;

  /// Minimum, maximum and void_samples take a pass over the data: they are 0 here, ingest fills them.
  [[nodiscard]] const Description& description() const;
  [[nodiscard]] const std::vector<InputFile>& inputs() const;
  /// Sentences for whoever runs it: what was turned, assumed, left out.
  [[nodiscard]] const std::vector<std::string>& notes() const;

  /// The samples of a rectangle within the extent. Seams are compared inside `own` only, so that windows which
  /// overlap compare each sample once.
  /// fails  invalid_argument: beyond the extent, or a sample that is no height; io: names the file and rows
  /// cost   one read of each input there; memory: the result, GDAL's cache, and once more where inputs overlap
  [[nodiscard]] Window read(GridRect part, GridRect own) const;
  /// The same into a window that was used before: no new memory where its size is the same.
  void read_into(Window& window, GridRect part, GridRect own) const;
  [[nodiscard]] Window read(GridRect part) const { return read(part, GridRect{{0, 0}, {-1, -1}}); }

  /// An input has samples there; where none does, all is void.
  [[nodiscard]] bool touches(GridRect part) const;
  /// Of the largest block of an input that GDAL reads as a whole.
  [[nodiscard]] std::uint64_t block_bytes() const;

  /// What the reads so far have found.
  [[nodiscard]] SeamReport seams() const;
  /// Sentences on heights that look as if they meant no data, from what was read and the range of all heights.
  [[nodiscard]] std::vector<std::string> doubts(double minimum, double maximum) const;

  /// The files that an input would be read from if it were opened now. Fails as the constructor does.
  [[nodiscard]] std::vector<FileState> files_now(std::size_t input) const;

 private:
  struct Plan;
  struct Reader;
  Source();

  std::shared_ptr<const Plan> plan_;
  std::unique_ptr<Reader> reader_;
};

}  // namespace talus
