#pragma once
// Files that the command line names, as what they are named for.

#include <string>

#include "talus/database.hpp"

namespace talus::app {

/// fails  corrupt: what has other content is said to be that, and how to make a database of it; not_found, io,
/// unsupported
[[nodiscard]] Database open_database(const std::string& file, const OpenOptions& options = {});
/// The same without opening it, for work that opens it itself.
void require_database(const std::string& file);
/// Whether a file holds a stream, or has a stream's name and is no database.
[[nodiscard]] bool holds_stream(const std::string& file);
/// As require_database of a file that should be an .rqt one.
void require_stream(const std::string& file);

}  // namespace talus::app
