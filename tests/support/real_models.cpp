#include "tests/support/real_models.hpp"

#include <cstdlib>

namespace talus::support {

RealModel real_model(const std::string& name, const TempFolder& scratch) {
  if (name == "jacksboro") {
    const std::filesystem::path script = std::filesystem::path(TALUS_SOURCE_DIR) / "tests/support/jacksboro.py";
    const std::filesystem::path file = scratch / "jacksboro.bil";
    const std::string command = std::string(TALUS_PYTHON) + " '" + script.string() + "' '" + file.string() + "'";
    if (std::system(command.c_str()) == 0 && std::filesystem::exists(file)) return {file, ""};
    return {std::nullopt, "the Jacksboro model of python-matplotlib-data could not be converted"};
  }
  const char* folder = std::getenv("TALUS_DEM_DIR");
  if (folder == nullptr) return {std::nullopt, "TALUS_DEM_DIR is not set: no real terrain to test with"};
  const std::filesystem::path file = std::filesystem::path(folder) / name;
  if (!std::filesystem::exists(file)) return {std::nullopt, file.string() + " is not there"};
  return {file, ""};
}

}  // namespace talus::support
