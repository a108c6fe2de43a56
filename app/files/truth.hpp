#pragma once
// The raster that a database was made from, to hold answers against.

#include <string>
#include <vector>

#include "talus/database.hpp"
#include "talus/ingest.hpp"

namespace talus::app {

/// Reads the raster in a database's samples, by other code than ingest's. It keeps the raster open.
///
/// against   files, folders and @lists, as ingest takes them; at least one
/// inputs    how they are read: as when the database was made
/// database  its name, for sentences
/// fails     as PlainReader; invalid_argument: another number of samples, samples in other places, or another CRS
[[nodiscard]] SampleReader open_truth(const std::vector<std::string>& against, const InputOptions& inputs,
                                      const Description& description, const std::string& database);

/// That reader, which fails with invalid_argument where a sample the database keeps is another one in the raster; of a
/// database with a finest tolerance, where a vertex is. Opens the database for each window, and closes it again.
[[nodiscard]] SampleReader of_same_heights(SampleReader truth, const std::vector<std::string>& against,
                                           const std::string& database);

/// "alps.tif", "north.tif and 3 more".
[[nodiscard]] std::string name_of(const std::vector<std::string>& against);

}  // namespace talus::app
