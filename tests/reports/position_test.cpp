// Reports of rasters that state their position otherwise than by a geotransform, or not at all.

#include <memory>

#include <gdal_priv.h>

#include "talus/ingest.hpp"
#include "tests/reports/report.hpp"

namespace talus::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Position : public Report {
 protected:
  void write_bare(const std::string& name, const std::string& crs = "") const {
    write(name, {slope()}, {.type = GDT_Int16, .crs = crs, .geotransform = std::nullopt});
  }
  /// Control points at the corners of the usual grid; the last one moved by so many metres.
  void add_control_points(const std::string& name, double moved) const {
    const std::unique_ptr<GDALDataset> dataset(
        GDALDataset::Open((folder / name).c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
    std::vector<GDAL_GCP> points(4);
    GDALInitGCPs(4, points.data());
    for (int i = 0; i < 4; ++i) {
      GDAL_GCP& point = points[static_cast<std::size_t>(i)];
      point.dfGCPPixel = i % 2 * kSide;
      point.dfGCPLine = i / 2 * kSide;
      point.dfGCPX = 500000 + 10 * point.dfGCPPixel + (i == 3 ? moved : 0);
      point.dfGCPY = 5600400 - 10 * point.dfGCPLine;
    }
    OGRSpatialReference crs;
    crs.importFromEPSG(25832);
    ASSERT_EQ(dataset->SetGCPs(4, points.data(), &crs), CE_None);
    GDALDeinitGCPs(4, points.data());
  }
};

// geotiffjs/geotiff.js#186: no tie point at all.
TEST_F(Position, ARasterWithoutPositionCountsItsSamplesAndSaysSo) {
  write_bare("bare.tif");
  const Outcome outcome = ingest({"bare.tif", "b.talus", "--json"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("states no position: its samples count from 0,0"));
  EXPECT_EQ(json_of(talus({"info", "b.talus", "--json"})).at("region"),
            nlohmann::json::parse("[0.5, -39.5, 39.5, -0.5]"));
}

// ASFHyP3/hyp3-isce2#82: a coordinate system and nothing that places the raster in it.
TEST_F(Position, ACoordinateSystemWithoutPositionIsRefused) {
  write_bare("lost.tif", "EPSG:25832");
  write_bare("bare.tif");
  expect_refusal(ingest({"lost.tif", "b.talus"}), {failed}, {"lost.tif", "no position"});
  expect_refusal(ingest({"bare.tif", "b.talus", "--srs", "EPSG:25832"}), {failed}, {"bare.tif", "no position"});
  expect_refusal(ingest({"bare.tif", "b.talus", "--srs", "EPSG:4326"}), {failed}, {"bare.tif", "no position"});
}

TEST_F(Position, TwoRastersWithoutPositionAreNotJoined) {
  write_bare("bare1.tif");
  write_bare("bare2.tif");
  write("placed.tif", {slope()}, {.type = GDT_Int16, .crs = ""});
  const Outcome both = ingest({"bare1.tif", "bare2.tif", "b.talus"});
  expect_refusal(both, {failed}, {"bare1.tif and 1 more state no position"});
  EXPECT_THAT(both.err, Not(HasSubstr("does")));
  expect_refusal(ingest({"placed.tif", "bare2.tif", "b.talus"}), {failed}, {"bare2.tif states no position"});
}

// OSGeo/gdal#8083: control points. On a grid they are one; off it they are named.
TEST_F(Position, ControlPointsOnAGridAreAGeotransform) {
  write_bare("gcp.tif");
  add_control_points("gcp.tif", 0);
  const Outcome outcome = ingest({"gcp.tif", "g.talus"});
  ASSERT_EQ(outcome.exit_code, done) << outcome.err;
  const nlohmann::json info = json_of(talus({"info", "g.talus", "--json"}));
  const std::vector<double> expected{500005, 5600005, 500395, 5600395};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(info.at("region")[i].get<double>(), expected[i], 1e-6);
  EXPECT_THAT(info.at("crs").get<std::string>(), HasSubstr("UTM zone 32N"));
}

TEST_F(Position, OtherStatementsOfPositionAreNamed) {
  write_bare("gcp.tif");
  add_control_points("gcp.tif", 700);
  expect_refusal(ingest({"gcp.tif", "g.talus"}), {failed}, {"gcp.tif", "4 ground control points", "gdalwarp"});

  // opticks-org/opticks#461: the coefficients of a camera.
  write_bare("rpc.tif");
  write_bytes(folder / "rpc.tif.aux.xml",
              "<PAMDataset><Metadata domain=\"RPC\"><MDI key=\"LINE_OFF\">20</MDI><MDI "
              "key=\"SAMP_OFF\">20</MDI></Metadata></PAMDataset>");
  expect_refusal(ingest({"rpc.tif", "g.talus"}), {failed}, {"rpc.tif", "RPC"});

  write_bare("arrays.tif");
  write_bytes(
      folder / "arrays.tif.aux.xml",
      "<PAMDataset><Metadata domain=\"GEOLOCATION\"><MDI key=\"X_DATASET\">x.tif</MDI></Metadata></PAMDataset>");
  expect_refusal(ingest({"arrays.tif", "g.talus"}), {failed}, {"arrays.tif", "GEOLOCATION"});
}

// girder/large_image#676: a world file, and no coordinate system.
TEST_F(Position, AWorldFileIsAPosition) {
  write_bare("w.tif");
  write_bytes(folder / "w.tfw", "10\n0\n0\n-10\n500005\n5600395\n");
  ASSERT_EQ(ingest({"w.tif", "w.talus"}).exit_code, done);
  EXPECT_EQ(json_of(talus({"info", "w.talus", "--json"})).at("region"),
            nlohmann::json::parse("[500005.0, 5600005.0, 500395.0, 5600395.0]"));
}

}  // namespace
}  // namespace talus::support
