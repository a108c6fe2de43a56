#pragma once
// Opens files that the command line names, and says what they are where they are something else.

#include <string>

#include "talus/database.hpp"
#include "talus/stream.hpp"

namespace talus::app {

/// fails  corrupt: it is another kind of file; not_found, io, unsupported
[[nodiscard]] Database open_database(const std::string& file, const OpenOptions& options = {});
/// fails  corrupt: it is another kind of file
void require_database(const std::string& file);
void require_stream(const std::string& file);
/// Whether a file holds a stream, or is named like one and is no database.
[[nodiscard]] bool holds_stream(const std::string& file);
/// Moves the answer out of a stream.
/// fails  invalid_argument: it is an increment
[[nodiscard]] RestrictedQuadtree answer_of(Stream& stream, const std::string& file);

}  // namespace talus::app
