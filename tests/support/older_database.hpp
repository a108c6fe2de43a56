#pragma once
// A file as programs before format 3 made it.

#include <filesystem>

namespace talus::support {

/// With a named table, as all of them had; under another name it is nobody's database.
void write_older_database(const std::filesystem::path& file, const char* table = "header");

}  // namespace talus::support
