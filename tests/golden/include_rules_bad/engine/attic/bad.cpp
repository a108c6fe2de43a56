#include "engine/quadtree/grid.hpp"  // refused
