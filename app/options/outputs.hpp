#pragma once
// The files that --output names.

#include <string>
#include <vector>

#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {

/// Refuses before the work what would fail after it: an unknown ending, a missing folder, an output that is an input.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);
/// Refuses an output that is an input, under whatever name. "-" and @lists are no files.
void require_no_input(const std::string& output, const std::vector<std::string>& inputs);
/// what  "a report"
void require_ending(const std::string& output, const char* what, const std::vector<std::string>& endings);

/// Writes the answer itself to .rqt files, and its mesh to others. A file appears whole or not at all.
/// returns  the largest distance between a file's surface and the answer's, see write_mesh
Metres write_outputs(const RestrictedQuadtree& answer, const Mesh& mesh, const Description& description,
                     const std::vector<std::string>& outputs, const StreamOptions& options = {});
/// Writes a whole file or none.
void write_text(const std::string& output, const std::string& text);

}  // namespace talus::app
