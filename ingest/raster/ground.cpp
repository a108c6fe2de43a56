#include "ingest/raster/ground.hpp"

#include <cmath>
#include <numbers>

#include <ogr_spatialref.h>

namespace talus {

GroundScale ground_scale(const Description& d) {
  OGRSpatialReference crs;
  const double width = std::abs(d.mapping.dx), height = std::abs(d.mapping.dy);
  if (d.crs_wkt.empty() || crs.importFromWkt(d.crs_wkt.c_str()) != OGRERR_NONE) {
    return GroundScale::planar(Metres{width}, Metres{height});
  }
  if (crs.IsGeographic() != 0) {
    const double degrees = crs.GetAngularUnits() * 180 / std::numbers::pi;
    GridMapping mapping = d.mapping;
    for (double* v : {&mapping.x0, &mapping.y0, &mapping.dx, &mapping.dy}) *v *= degrees;
    const double inverse = crs.GetInvFlattening();
    return GroundScale::geographic(mapping, d.extent, Metres{crs.GetSemiMajor()}, inverse == 0 ? 0 : 1 / inverse);
  }
  const double unit = crs.GetLinearUnits();
  return GroundScale::planar(Metres{width * unit}, Metres{height * unit});
}

}  // namespace talus
