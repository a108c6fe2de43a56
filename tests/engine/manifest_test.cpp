// The header of a database: what was said is what is read, and nonsense is refused.

#include "engine/page/manifest.hpp"

#include <cmath>
#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/page/page_layout.hpp"
#include "talus/failure.hpp"

namespace talus::support {
namespace {

using Json = nlohmann::json;

Manifest example() {
  Manifest m;
  Description& d = m.description;
  d.extent = {{0, 0}, {3600, 1800}};
  d.mapping = {7.0000000000000012, 47, 1.0 / 3600, -1.0 / 3600};
  d.crs_wkt = "GEOGCS[\"WGS 84\", \"quotes\" and Zürich]";
  d.crs = {"WGS 84", 4326, true, 1, 1, 6378137, 1 / 298.257223563};
  d.source_name = "höhe \\ \"x\".tif";
  d.source_type = "Float32";
  d.vertical_unit = "foot";
  d.metres_per_unit = 0.3048;
  d.step = {0.1, 10, -3.25, true};
  d.minimum_height = -431.5;
  d.maximum_height = 8848.86;
  d.void_samples = 12345678901;
  d.void_weight = 0.5;
  d.lossy = Metres{0.25};
  m.bands = band_count(d.extent);
  m.generation = 3;
  m.top_generations = {2};
  return m;
}

Json json_of(const Manifest& m) {
  const auto bytes = encode(m);
  return Json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

Manifest decode_text(const std::string& text) { return decode_manifest(std::as_bytes(std::span(text))); }

/// Why a header with one value changed is refused; 0 if it is not.
int refused(const char* pointer, const Json& value) {
  Json json = json_of(example());
  json.at(Json::json_pointer(pointer)) = value;
  try {
    static_cast<void>(decode_text(json.dump()));
    return 0;
  } catch (const Failure& failure) {
    EXPECT_STRNE(failure.what(), "");
    return static_cast<int>(failure.cause());
  }
}
constexpr int kCorrupt = static_cast<int>(Cause::corrupt), kUnsupported = static_cast<int>(Cause::unsupported);

TEST(Manifest, DecodeOfEncodeIsTheManifest) {
  const Manifest m = example(), back = decode_manifest(encode(m));
  const Description &d = m.description, &b = back.description;
  EXPECT_EQ(back.bands, m.bands);
  EXPECT_EQ(back.generation, m.generation);
  EXPECT_EQ(back.top_generations, m.top_generations);
  EXPECT_EQ(b.extent, d.extent);
  EXPECT_EQ(b.mapping, d.mapping);
  EXPECT_EQ(b.crs_wkt, d.crs_wkt);
  EXPECT_EQ(b.crs, d.crs);
  EXPECT_EQ(b.source_name, d.source_name);
  EXPECT_EQ(b.source_type, d.source_type);
  EXPECT_EQ(b.vertical_unit, d.vertical_unit);
  EXPECT_EQ(b.metres_per_unit, d.metres_per_unit);
  EXPECT_EQ(b.step, d.step);
  EXPECT_EQ(b.minimum_height, d.minimum_height);
  EXPECT_EQ(b.maximum_height, d.maximum_height);
  EXPECT_EQ(b.void_samples, d.void_samples);
  EXPECT_EQ(b.void_weight, d.void_weight);
  EXPECT_EQ(b.lossy.value, d.lossy.value);
  EXPECT_EQ(b.error_metric, d.error_metric);
}

TEST(Manifest, EachFactOfACrsAndOfItsHeightsComesBackInItsPlace) {
  Manifest m = example();
  Description& d = m.description;
  d.crs = {"gon and yards", 4807, true, 0.9144, 0.9, 6378249.2, 1 / 293.466};  // no two are alike
  d.finest_tolerance = Metres{0.75};
  const Description back = decode_manifest(encode(m)).description;
  EXPECT_EQ(back.crs, d.crs);
  EXPECT_EQ(back.finest_tolerance.value, 0.75);
  // The names under which a reader of another kind finds them: docs/format/v3.md.
  const Json crs = json_of(m).at("crs");
  EXPECT_EQ(crs.at("epsg"), 4807);
  EXPECT_EQ(crs.at("metres_per_unit"), 0.9144);
  EXPECT_EQ(crs.at("degrees_per_unit"), 0.9);
  EXPECT_EQ(crs.at("equatorial_radius"), 6378249.2);
  EXPECT_EQ(crs.at("flattening"), 1 / 293.466);
  EXPECT_EQ(json_of(m).at("vertical").at("metres_per_unit"), 0.3048);
}

TEST(Manifest, ErrorsAreExactAndHaveAMetric) {
  Manifest m = example();
  m.description.error_metric = ErrorMetric::perpendicular;
  EXPECT_EQ(decode_manifest(encode(m)).description.error_metric, ErrorMetric::perpendicular);
  for (const char* kind : {"nested", "midpoint", "average"}) EXPECT_EQ(refused("/errors/kind", kind), kUnsupported);
  EXPECT_EQ(refused("/errors/metric", "geodesic"), kUnsupported);
  EXPECT_EQ(refused("/errors/kind", 3), kCorrupt);
  EXPECT_EQ(refused("/errors/metric", nullptr), kCorrupt);
}

TEST(Manifest, AnImpossibleCoordinateSystemIsCorrupt) {
  EXPECT_EQ(refused("/crs/metres_per_unit", 0), kCorrupt);
  EXPECT_EQ(refused("/crs/degrees_per_unit", -1), kCorrupt);
  EXPECT_EQ(refused("/crs/equatorial_radius", 0), kCorrupt);
  EXPECT_EQ(refused("/crs/flattening", 1), kCorrupt);
  EXPECT_EQ(refused("/crs/epsg", 1.5), kCorrupt);
  EXPECT_EQ(refused("/crs/geographic", "yes"), kCorrupt);
}

TEST(Manifest, OneOfBeforeTheMeaningOfACrsIsUnsupported) {
  Json json = json_of(example());
  json.erase("crs");
  json["crs_wkt"] = "";
  try {
    static_cast<void>(decode_text(json.dump()));
    ADD_FAILURE() << "taken";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.cause(), Cause::unsupported);
    EXPECT_NE(std::string(failure.what()).find("ingest the source again"), std::string::npos);
  }
}

TEST(Manifest, TheSameManifestIsTheSameBytes) { EXPECT_EQ(encode(example()), encode(example())); }

TEST(Manifest, AnotherVersionIsUnsupported) {
  EXPECT_EQ(refused("/talus", 1), kUnsupported);
  EXPECT_EQ(refused("/talus", kFormatVersion + 1), kUnsupported);
  EXPECT_EQ(refused("/talus", 0), kUnsupported);
  EXPECT_EQ(refused("/talus", -1), kUnsupported);
}

TEST(Manifest, AnotherPageLayoutIsUnsupported) {
  EXPECT_EQ(refused("/layout/band_levels", kBandLevels + 1), kUnsupported);
  EXPECT_EQ(refused("/layout/page_side", 2 * kPageSide), kUnsupported);
}

TEST(Manifest, WhatIsNoHeaderIsCorrupt) {
  for (const char* text :
       {"", "{", "[]", "null", "7", "{}", "{\"talus\": 3}", "{\"talus\": \"one\"}", "\xff\xfe", "{\"talus\": null}"}) {
    try {
      static_cast<void>(decode_text(text));
      ADD_FAILURE() << "took " << text;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.cause(), Cause::corrupt) << text;
    }
  }
  EXPECT_THROW(static_cast<void>(decode_text(std::string(100000, '['))), Failure);
}

TEST(Manifest, EveryTruncationIsRefused) {
  const auto bytes = encode(example());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(static_cast<void>(decode_manifest(std::span(bytes).first(size))), Failure) << size << " bytes";
  }
}

TEST(Manifest, EveryFieldIsNeeded) {
  const Json whole = json_of(example());
  for (const auto& [name, group] : whole.items()) {
    Json json = whole;
    json.erase(name);
    EXPECT_THROW(static_cast<void>(decode_text(json.dump())), Failure) << name;
  }
}

TEST(Manifest, ImpossibleValuesAreCorrupt) {
  EXPECT_EQ(refused("/extent", Json({0, 0, -1, 5})), kCorrupt);
  EXPECT_EQ(refused("/extent", Json({0, 0, 5})), kCorrupt);
  EXPECT_EQ(refused("/extent", Json({0, 0, kMaxExtent, 5})), kCorrupt);
  EXPECT_EQ(refused("/extent", Json({-2147483647 - 1, 0, 2147483647, 5})), kCorrupt);
  EXPECT_EQ(refused("/extent", "wide"), kCorrupt);
  EXPECT_EQ(refused("/layout/bands", 1), kCorrupt);
  EXPECT_EQ(refused("/layout/bands", 1000000), kCorrupt);
  EXPECT_NE(refused("/layout/page_side", "large"), 0);
  EXPECT_EQ(refused("/mapping/dx", 0), kCorrupt);
  EXPECT_EQ(refused("/mapping/dx", -1), kCorrupt);
  EXPECT_EQ(refused("/mapping/dy", 1), kCorrupt);
  EXPECT_EQ(refused("/step/scale", 0), kCorrupt);
  EXPECT_EQ(refused("/step/divisor", 0), kCorrupt);
  EXPECT_EQ(refused("/step/divisor", -10), kCorrupt);
  EXPECT_EQ(refused("/vertical/metres_per_unit", 0), kCorrupt);
  EXPECT_EQ(refused("/errors/void_weight", -1), kCorrupt);
  EXPECT_EQ(refused("/errors/lossy_bound", -1), kCorrupt);
  EXPECT_EQ(refused("/top_generations", Json::array()), kCorrupt);
  EXPECT_EQ(refused("/top_generations", Json({0, 0})), kCorrupt);
  EXPECT_EQ(refused("/generation", -1), kCorrupt);
  EXPECT_EQ(refused("/heights/minimum", "low"), kCorrupt);
  EXPECT_EQ(refused("/heights/minimum", nullptr), kCorrupt);
}

TEST(Provenance, DecodeOfEncodeIsTheProvenance) {
  Provenance p;
  p.sources = {{"höhe.tif", "GTiff", "Int16", 1201, 1200, 123456789012, 0xfedcba9876543210},
               {"b.hgt", "SRTMHGT", "Int16", 1, 2, 3, 4}};
  p.made_by = "talus 9, IngestOptions::void_weight 2";
  p.generation = 7;
  p.vertices_above = {{0, 100}, {0.001, 90}, {50000, 0}};
  const Provenance back = decode_provenance(encode(p));
  ASSERT_EQ(back.sources.size(), 2u);
  EXPECT_EQ(back.sources[0].name, p.sources[0].name);
  EXPECT_EQ(back.sources[0].driver, p.sources[0].driver);
  EXPECT_EQ(back.sources[0].type, p.sources[0].type);
  EXPECT_EQ(back.sources[0].cols, p.sources[0].cols);
  EXPECT_EQ(back.sources[0].rows, p.sources[0].rows);
  EXPECT_EQ(back.sources[0].bytes, p.sources[0].bytes);
  EXPECT_EQ(back.sources[0].checksum, p.sources[0].checksum);
  EXPECT_EQ(back.made_by, p.made_by);
  EXPECT_EQ(back.generation, p.generation);
  EXPECT_EQ(back.vertices_above, p.vertices_above);
}

TEST(Provenance, WhatIsNoneIsRefused) {
  for (const char* text : {"", "{", "[]", "{}", "{\"sources\": 7}",
                           "{\"sources\": [], \"made_by\": 1, \"generation\": 0, \"vertices_above\": []}",
                           "{\"sources\": [], \"made_by\": \"\", \"generation\": 0, \"vertices_above\": [[1]]}"}) {
    EXPECT_THROW(static_cast<void>(decode_provenance(std::as_bytes(std::span(text, std::strlen(text))))), Failure)
        << text;
  }
}

TEST(Manifest, NumbersThatDoNotFitTheirTypeAreRefused) {
  const std::int64_t wraps = std::int64_t{1} << 32;
  EXPECT_NE(refused("/talus", wraps + kFormatVersion), 0) << "version 1 only after it wraps";
  EXPECT_NE(refused("/talus", 1e300), 0);
  EXPECT_NE(refused("/talus", 1.5), 0);
  EXPECT_NE(refused("/extent", Json({wraps, wraps, wraps + 3600, wraps + 1800})), 0);
  EXPECT_NE(refused("/extent", Json({0, 0, 3600.5, 1800})), 0);
  EXPECT_NE(refused("/layout/bands", wraps + band_count(example().description.extent)), 0);
  EXPECT_NE(refused("/heights/void_samples", -1), 0);
}

}  // namespace
}  // namespace talus::support
