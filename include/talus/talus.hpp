#pragma once
// Talus: start here.
//
//   talus::ingest("alps.tif", "alps.talus");
//   auto alps = talus::Database::open("alps.talus");
//   auto now = alps.snapshot();
//   auto mesh = now.mesh({7.5, 45.9, 7.8, 46.1}, talus::Metres{2});   // every sample within 2 m of it
//   talus::write_mesh(mesh, now.description(), "matterhorn.ply");
//
// The verbs: ingest, open, snapshot; then ask (with a Question), mesh, height, heights, profile, samples; and
// triangulate, write_mesh, verify. Each of their headers says shapes, units, failures and cost; docs/architecture.md
// shows the way of the data through the folders.

#include "talus/ingest.hpp"
#include "talus/raster_output.hpp"
#include "talus/read.hpp"
