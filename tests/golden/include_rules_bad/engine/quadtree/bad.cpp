#include "engine/machine/cpu.hpp"
#include "engine/quadtree/grid.hpp"
#include "engine/page/page_codec.hpp"  // refused
#include "engine/geo/ground_scale.hpp"      // refused
