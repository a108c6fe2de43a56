#pragma once
// Talus: start here.
//
//   talus::ingest("alps.tif", "alps.talus");                          // talus/ingest.hpp
//   auto alps = talus::Database::open("alps.talus");
//   auto now = alps.snapshot();
//   auto mesh = now.mesh({7.5, 45.9, 7.8, 46.1}, talus::Metres{2});   // every sample within 2 m of it
//   talus::write_mesh(mesh, now.description(), "matterhorn.ply");
//
// Six verbs: open, snapshot, ask, triangulate, verify, write. Their headers state shapes, units, failures and cost.
// docs/architecture.md follows the data through the folders.
//
// This header holds everything that reads. Link talus::read: it needs neither GDAL nor PROJ. talus/ingest.hpp makes
// databases, talus/raster_output.hpp writes rasters: link talus::ingest for them, or talus::talus for everything.

#include "talus/accuracy.hpp"
#include "talus/bitree.hpp"
#include "talus/database.hpp"
#include "talus/description.hpp"
#include "talus/failure.hpp"
#include "talus/increment.hpp"
#include "talus/positions.hpp"
#include "talus/progression.hpp"
#include "talus/quadtree.hpp"
#include "talus/session.hpp"
#include "talus/stream.hpp"
#include "talus/strip.hpp"
#include "talus/units.hpp"
#include "talus/version.hpp"
