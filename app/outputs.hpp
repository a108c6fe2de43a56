#pragma once
// Files that answers go to.

#include <string>
#include <vector>

#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {

/// What would fail after the work: another ending than a mesh's or a stream's, or no such folder.
void check_outputs(const std::vector<std::string>& outputs);

/// Each whole or not at all: .rqt the answer itself, any other ending its mesh.
/// returns  how far a file's surface may lie from the answer's, see write_mesh: the largest of them
Metres write_outputs(const RestrictedQuadtree& answer, const Mesh& mesh, const Description& description,
                     const std::vector<std::string>& outputs, const StreamOptions& options = {});

}  // namespace talus::app
