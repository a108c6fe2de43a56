#pragma once
#include <vector>
#include "talus/units.hpp"
#include "engine/grid.hpp"  // refused
#include <fmt/format.h>     // refused
#include <lmdb.h>           // refused
