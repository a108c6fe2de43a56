#pragma once
// Files that answers go to.

#include <string>
#include <vector>

#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {

/// What would fail after the work: another ending than a mesh's or a stream's, or no such folder; and what would
/// destroy a file that is read, under whatever name.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);
/// The last of these alone. "-" and @lists are no names of files.
void require_no_input(const std::string& output, const std::vector<std::string>& inputs);

/// Each whole or not at all: .rqt the answer itself, any other ending its mesh.
/// returns  how far a file's surface may lie from the answer's, see write_mesh: the largest of them
Metres write_outputs(const RestrictedQuadtree& answer, const Mesh& mesh, const Description& description,
                     const std::vector<std::string>& outputs, const StreamOptions& options = {});

}  // namespace talus::app
