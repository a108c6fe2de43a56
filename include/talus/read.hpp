#pragma once
// All of Talus that opens databases, asks, and reads and writes streams and meshes. Link talus::read: it needs no GDAL.

#include "talus/accuracy.hpp"
#include "talus/bitree.hpp"
#include "talus/database.hpp"
#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/increment.hpp"
#include "talus/progression.hpp"
#include "talus/quadtree.hpp"
#include "talus/session.hpp"
#include "talus/stream.hpp"
#include "talus/strip.hpp"
#include "talus/units.hpp"
