// What the text of a CRS says, against PROJ, which shares no code with it.

#include "engine/geo/crs_text.hpp"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "tests/support/random.hpp"

namespace talus::support {
namespace {

std::string text_of(const OGRSpatialReference& crs, const char* format) {
  const std::string option = std::string("FORMAT=") + format;
  const char* const options[] = {option.c_str(), nullptr};
  char* text = nullptr;
  const bool done = crs.exportToWkt(&text, options) == OGRERR_NONE;
  std::string wkt = done && text != nullptr ? text : "";
  CPLFree(text);
  return wkt;
}

void expect_facts(const OGRSpatialReference& crs, const std::string& wkt, const std::string& what) {
  const CrsFacts facts = facts_of_wkt(wkt);
  EXPECT_TRUE(facts.name.starts_with(crs.GetName())) << what << facts.name;  // WKT 1 adds "(deprecated)"
  ASSERT_EQ(facts.is_geographic, crs.IsGeographic() != 0) << what << wkt;
  if (facts.is_geographic) {
    EXPECT_NEAR(facts.degrees_per_unit, crs.GetAngularUnits() * 180 / std::numbers::pi, 1e-12) << what;
    EXPECT_NEAR(facts.equatorial_radius, crs.GetSemiMajor(), 1e-6) << what;
    const double inverse = crs.GetInvFlattening();
    EXPECT_NEAR(facts.flattening, inverse == 0 ? 0 : 1 / inverse, 1e-14) << what;
  } else {
    EXPECT_NEAR(facts.metres_per_unit / crs.GetLinearUnits(), 1, 1e-13) << what;
  }
}

TEST(CrsText, SaysWhatProjSays) {
  CPLPushErrorHandler(CPLQuietErrorHandler);
  int geographic = 0, projected = 0, in_feet = 0;
  // Every kind of number: geographic ones in degrees and gon, projected ones in metres, feet and links.
  for (int code = 2000; code<33000; code += code> 4000 && code < 5000 ? 1 : 7) {
    OGRSpatialReference crs;
    if (crs.importFromEPSG(code) != OGRERR_NONE || (crs.IsGeographic() == 0 && crs.IsProjected() == 0)) continue;
    for (const char* format : {"WKT2_2019", "WKT1_GDAL"}) {
      const std::string wkt = text_of(crs, format);
      if (wkt.empty()) continue;  // WKT 1 does not have them all
      expect_facts(crs, wkt, "EPSG:" + std::to_string(code) + " as " + format + " ");
      // A number that was withdrawn may stand for another one.
      EXPECT_EQ(facts_of_wkt(wkt).epsg, std::atoi(crs.GetAuthorityCode(nullptr))) << format;
      ++(crs.IsGeographic() != 0 ? geographic : projected);
      in_feet += crs.IsProjected() != 0 && crs.GetLinearUnits() < 0.5 ? 1 : 0;
    }
  }
  CPLPopErrorHandler();
  EXPECT_GT(geographic, 500);
  EXPECT_GT(projected, 500);
  EXPECT_GT(in_feet, 50);
}

TEST(CrsText, ACompoundSystemIsItsHorizontalPart) {
  for (const char* name : {"EPSG:4326+5773", "EPSG:25832+7837", "EPSG:2225+6360"}) {
    OGRSpatialReference crs;
    ASSERT_EQ(crs.SetFromUserInput(name), OGRERR_NONE);
    expect_facts(crs, text_of(crs, "WKT2_2019"), name);
  }
  EXPECT_EQ(facts_of_wkt(R"(COMPOUNDCRS["a + b",GEOGCRS["a",DATUM["d",ELLIPSOID["e",6400000,300]],CS[ellipsoidal,2],)"
                         R"(ANGLEUNIT["gon",0.015707963267949],ID["EPSG",4807]],VERTCRS["b",VDATUM["v"]]])")
                .epsg,
            4807);
}

TEST(CrsText, ABoundSystemIsItsSource) {
  const CrsFacts facts =
      facts_of_wkt(R"(BOUNDCRS[SOURCECRS[GEOGCRS["a",DATUM["d",ELLIPSOID["e",6400000,300]],CS[ellipsoidal,2],)"
                   R"(ANGLEUNIT["gon",0.015707963267949],ID["EPSG",4807]]],TARGETCRS[GEOGCRS["WGS 84",DATUM["w",)"
                   R"(ELLIPSOID["w",6378137,298.257223563]],ID["EPSG",4326]]],ABRIDGEDTRANSFORMATION["t"]])");
  EXPECT_TRUE(facts.is_geographic);
  EXPECT_EQ(facts.epsg, 4807);
  EXPECT_EQ(facts.equatorial_radius, 6400000);
  EXPECT_EQ(facts.flattening, 1 / 300.0);
  EXPECT_NEAR(facts.degrees_per_unit, 0.9, 1e-9);
}

TEST(CrsText, CoordinatesFromTheCentreOfTheEarthAreNoLongitudes) {
  const std::string datum = R"(DATUM["d",ELLIPSOID["e",6400000,300]])";
  const CrsFacts facts = facts_of_wkt("GEODCRS[\"a\"," + datum + R"(,CS[Cartesian,3],LENGTHUNIT["kilometre",1000]])");
  EXPECT_FALSE(facts.is_geographic);
  EXPECT_EQ(facts.metres_per_unit, 1000);
  EXPECT_TRUE(facts_of_wkt("GEODCRS[\"a\"," + datum + ",CS[ellipsoidal,2]]").is_geographic);
}

TEST(CrsText, QuotesInNamesAndAnyTextAreHarmless) {
  EXPECT_EQ(facts_of_wkt(R"(LOCAL_CS["a ""quoted"" name",UNIT["foot",0.3048]])").name, "a \"quoted\" name");
  EXPECT_EQ(facts_of_wkt(R"(LOCAL_CS["a",UNIT["foot",0.3048]])").metres_per_unit, 0.3048);
  for (const std::string wkt : {"", "[", "GEOGCS", "GEOGCS[", "GEOGCS[\"a", "GEOGCS[\"a\"", "GEOGCS[,,,", "]]]]",
                                "PROJCS[\"a\",UNIT[\"m\",-1]]", "PROJCS[\"a\",UNIT[\"m\",nan]]",
                                "GEOGCS[\"a\",DATUM[\"d\",SPHEROID[\"s\",0,0]]]"}) {
    const CrsFacts facts = facts_of_wkt(wkt);
    EXPECT_FALSE(facts.is_geographic) << wkt;
    EXPECT_EQ(facts.metres_per_unit, 1) << wkt;
  }
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "A[";
  EXPECT_EQ(facts_of_wkt(deep), CrsFacts{});
  Random random(7);
  const std::string letters = "GEOCS[]\",19.-e ()PRJAUNITellipsoid";
  for (int i = 0; i < 20000; ++i) {
    std::string wkt;
    for (int k = 0; k < 40; ++k)
      wkt += letters[static_cast<std::size_t>(random.unit() * static_cast<double>(letters.size()))];
    const CrsFacts facts = facts_of_wkt(wkt);
    EXPECT_TRUE(std::isfinite(facts.metres_per_unit) && facts.metres_per_unit > 0) << wkt;
  }
}

}  // namespace
}  // namespace talus::support
