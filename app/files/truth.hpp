#pragma once
// The raster that a database was made from, to compare answers with.

#include <string>
#include <vector>

#include "talus/database.hpp"
#include "talus/ingest.hpp"

namespace talus::app {

/// A reader of the raster at the database's samples, with other code than that of ingest. It keeps the raster open.
///
/// against   files, folders and @lists; at least one
/// inputs    the options that ingest had
/// database  its name
/// fails     as PlainReader; invalid_argument: another number of samples, samples in other places, or another CRS
[[nodiscard]] SampleReader open_truth(const std::vector<std::string>& against, const InputOptions& inputs,
                                      const Description& description, const std::string& database);

/// The same reader, but with invalid_argument where a sample in the database differs from the raster. If the database
/// has a finest tolerance, it compares the vertices. Opens the database for each window, and closes it again.
[[nodiscard]] SampleReader of_same_heights(SampleReader truth, const std::vector<std::string>& against,
                                           const std::string& database);

/// "alps.tif", "north.tif and 3 more".
[[nodiscard]] std::string name_of(const std::vector<std::string>& against);

}  // namespace talus::app
