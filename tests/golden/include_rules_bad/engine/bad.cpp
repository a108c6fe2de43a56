#include "engine/bad.hpp"

#include <cmath>
#include <fmt/format.h>
#include <thread>                   // refused
#include <filesystem>               // refused
#include <gdal_priv.h>              // refused
#include <GeographicLib/Geodesic.hpp>  // refused

#include "engine/quadtree/grid.hpp"
#include "grid.hpp"                 // refused
#include "../storage/page_key.hpp"  // refused
#include "storage/page_key.hpp"     // refused
#include "talus/quadtree.hpp"
#include "talus/database.hpp"       // refused
