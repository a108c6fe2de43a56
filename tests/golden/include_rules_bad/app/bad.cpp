#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <gdal.h>              // refused
#include "talus/talus.hpp"
#include "engine/grid.hpp"     // refused
