#include "ingest/raster/crs.hpp"

#include <array>
#include <cstdlib>
#include <numbers>
#include <string_view>
#include <utility>

#include <cpl_conv.h>
#include <fmt/format.h>

#include "engine/geo/ground.hpp"
#include "engine/machine/fail.hpp"
#include "ingest/files/gdal_scope.hpp"
#include "talus/ingest.hpp"

namespace talus {

std::string wkt_of(const OGRSpatialReference& crs, const std::string& name) {
  GdalScope gdal;
  constexpr std::array<const char*, 2> kOptions{"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  const OGRErr status = crs.exportToWkt(&text, kOptions.data());
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  if (status != OGRERR_NONE)
    fail(Cause::unsupported, "{} has a coordinate system that cannot be written as WKT{}", name, gdal.reason());
  return wkt;
}

std::string wkt_of(const std::string& user_input, const char* option) {
  GdalScope gdal;
  OGRSpatialReference crs;
  // The limits keep GDAL from opening files and addresses.
  if (crs.SetFromUserInput(user_input.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) !=
      OGRERR_NONE) {
    refuse("{} {}: expected a coordinate system, such as EPSG:25832, WKT or a PROJ string{}", option, user_input,
           gdal.reason());
  }
  return wkt_of(crs, option);
}

OGRSpatialReference crs_from(const std::string& wkt) {
  GdalScope gdal;
  OGRSpatialReference crs;
  if (!wkt.empty() && crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    fail(Cause::unsupported, "cannot read the WKT of a coordinate system{}", gdal.reason());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

bool same_crs(const std::string& wkt, const std::string& other) {
  if (wkt == other) return true;
  if (wkt.empty() || other.empty()) return false;
  GdalScope gdal;
  const OGRSpatialReference a = crs_from(wkt), b = crs_from(other);
  constexpr std::array<const char*, 3> kOptions{"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                                "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
  return a.IsSame(&b, kOptions.data()) != 0;
}

OGRSpatialReference horizontal(const OGRSpatialReference& crs) {
  GdalScope gdal;
  OGRSpatialReference flat = crs;
  if (flat.IsCompound() != 0) flat.StripVertical();
  if (flat.GetAxesCount() > 2) flat.DemoteTo2D(nullptr);
  flat.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return flat;
}

bool has_heights(const OGRSpatialReference& crs) { return crs.IsCompound() != 0 || crs.GetAxesCount() > 2; }

bool same_heights(const OGRSpatialReference& crs, const OGRSpatialReference& other) {
  if (has_heights(crs) != has_heights(other) || crs.IsCompound() != other.IsCompound()) return false;
  if (!has_heights(crs)) return true;
  GdalScope gdal;
  return crs.IsCompound() != 0 ? crs.IsSameVertCS(&other) != 0 : crs.IsSameGeogCS(&other) != 0;
}

std::string with_heights_of(const OGRSpatialReference& target, const OGRSpatialReference& source) {
  GdalScope gdal;
  if (has_heights(target) || source.IsCompound() == 0) return wkt_of(target, "the target");
  const OGR_SRSNode* node = source.GetAttrNode("VERT_CS");
  char* text = nullptr;
  if (node == nullptr || node->exportToWkt(&text) != OGRERR_NONE) {
    CPLFree(text);
    fail(Cause::unsupported, "cannot read the WKT of a vertical coordinate system{}", gdal.reason());
  }
  OGRSpatialReference vertical;
  const OGRErr understood = vertical.importFromWkt(text);
  CPLFree(text);
  OGRSpatialReference both;
  const char* flat = target.GetName();
  const char* high = vertical.GetName();
  const std::string name = fmt::format("{} + {}", flat ? flat : "unnamed", high ? high : "unnamed");
  if (understood != OGRERR_NONE || both.SetCompoundCS(name.c_str(), &target, &vertical) != OGRERR_NONE)
    fail(Cause::unsupported, "cannot add the vertical coordinate system of the input to the target's{}", gdal.reason());
  return wkt_of(both, "the target");
}

CrsFacts facts_of_crs(const std::string& wkt) {
  GdalScope gdal;
  CrsFacts facts;
  OGRSpatialReference crs;
  if (wkt.empty() || crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return facts;
  if (const char* name = crs.GetName()) facts.name = name;
  const OGRSpatialReference flat = horizontal(crs);
  for (const OGRSpatialReference* named : {static_cast<const OGRSpatialReference*>(&crs), &flat}) {
    const char* authority = named->GetAuthorityName(nullptr);
    const char* code = named->GetAuthorityCode(nullptr);
    if (facts.epsg == 0 && authority != nullptr && code != nullptr && std::string_view(authority) == "EPSG")
      facts.epsg = std::atoi(code);
  }
  if (crs.IsGeographic() == 0) {
    facts.metres_per_unit = crs.GetLinearUnits();
    return facts;
  }
  facts.is_geographic = true;
  facts.degrees_per_unit = crs.GetAngularUnits() * 180 / std::numbers::pi;
  facts.equatorial_radius = crs.GetSemiMajor();
  const double inverse = crs.GetInvFlattening();
  facts.flattening = inverse == 0 ? 0 : 1 / inverse;
  return facts;
}

double full_turn(const std::string& wkt) { return Ground(facts_of_crs(wkt)).full_turn(); }

}  // namespace talus
