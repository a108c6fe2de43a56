#include "engine/page/manifest.hpp"

#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/machine/fail.hpp"
#include "engine/page/page_layout.hpp"

namespace talus {
namespace {

using Json = nlohmann::json;

/// Which samples errors look at: all of a vertex's diamond.
constexpr const char* kErrorKind = "exact";

/// Refuses values that would overflow later arithmetic.
void require_plausible(const Manifest& m) {
  const auto refuse = [](const char* what) { fail(Cause::corrupt, "corrupt: header: {}", what); };
  const Description& d = m.description;
  const auto within = [](std::int32_t v) { return v > -kMaxExtent && v < kMaxExtent; };
  if (!within(d.extent.first.col) || !within(d.extent.first.row) || !within(d.extent.last.col) ||
      !within(d.extent.last.row) || is_empty(d.extent)) {
    refuse("the extent is empty or too large");
  }
  if (m.bands != band_count(d.extent)) refuse("the number of bands does not match the extent");
  for (const double v :
       {d.mapping.x0, d.mapping.y0, d.mapping.dx, d.mapping.dy, d.step.scale, d.step.divisor, d.step.offset,
        d.metres_per_unit, d.crs.metres_per_unit, d.crs.degrees_per_unit, d.crs.equatorial_radius, d.crs.flattening,
        d.minimum_height, d.maximum_height, d.void_weight, d.lossy.value, d.finest_tolerance.value}) {
    if (!std::isfinite(v)) refuse("a number is not finite");
  }
  if (d.lossy.value < 0 || d.finest_tolerance.value < 0) refuse("the loss or the finest tolerance is negative");
  if (m.top_generations.size() != pages_of_band(m.bands - 1, d.extent).size())
    refuse("the number of coarsest pages does not match the extent");
  if (d.mapping.dx <= 0 || d.mapping.dy >= 0) refuse("the cells of the grid need dx > 0 and dy < 0");
  if (d.crs.metres_per_unit <= 0 || d.crs.degrees_per_unit <= 0 || d.crs.flattening >= 1 ||
      (d.crs.is_geographic && d.crs.equatorial_radius <= 0)) {
    refuse("the units or the ellipsoid of the CRS are impossible");
  }
  if (d.step.scale == 0 || d.step.divisor <= 0 || d.metres_per_unit <= 0 || d.void_weight < 0)
    refuse("the height step, the vertical unit or the void weight is out of range");
}

/// A whole number of its type: the JSON library alone would cut 2³² + 1 to 1.
template <class Int>
Int whole(const Json& json) {
  if (json.is_number_unsigned() && std::in_range<Int>(json.get<std::uint64_t>())) return json.get<Int>();
  if (json.is_number_integer() && !json.is_number_unsigned() && std::in_range<Int>(json.get<std::int64_t>()))
    return json.get<Int>();
  fail(Cause::corrupt, "corrupt: header: {} is not a whole number of {} bits", json.dump(), 8 * sizeof(Int));
}

}  // namespace

std::vector<std::byte> encode(const Manifest& m) {
  const Description& d = m.description;
  const Json json = {
      {"talus", kFormatVersion},
      {"layout", {{"band_levels", kBandLevels}, {"page_side", kPageSide}, {"bands", m.bands}}},
      {"extent", {d.extent.first.col, d.extent.first.row, d.extent.last.col, d.extent.last.row}},
      {"mapping", {{"x0", d.mapping.x0}, {"y0", d.mapping.y0}, {"dx", d.mapping.dx}, {"dy", d.mapping.dy}}},
      {"crs",
       {{"wkt", d.crs_wkt},
        {"name", d.crs.name},
        {"epsg", d.crs.epsg},
        {"geographic", d.crs.is_geographic},
        {"metres_per_unit", d.crs.metres_per_unit},
        {"degrees_per_unit", d.crs.degrees_per_unit},
        {"equatorial_radius", d.crs.equatorial_radius},
        {"flattening", d.crs.flattening}}},
      {"source", {{"name", d.source_name}, {"type", d.source_type}}},
      {"vertical", {{"unit", d.vertical_unit}, {"metres_per_unit", d.metres_per_unit}}},
      {"step",
       {{"scale", d.step.scale}, {"divisor", d.step.divisor}, {"offset", d.step.offset}, {"integer", d.step.integer}}},
      {"heights", {{"minimum", d.minimum_height}, {"maximum", d.maximum_height}, {"void_samples", d.void_samples}}},
      {"errors",
       {{"kind", kErrorKind},
        {"metric", name_of(d.error_metric)},
        {"void_weight", d.void_weight},
        {"lossy_bound", d.lossy.value},
        {"finest_tolerance", d.finest_tolerance.value}}},
      {"generation", m.generation},
      {"top_generations", m.top_generations},
  };
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

namespace {

Description description_of(const Json& json) {
  Description d;
  const Json& extent = json.at("extent");
  const auto side = [&](std::size_t i) { return whole<std::int32_t>(extent.at(i)); };
  d.extent = {{side(0), side(1)}, {side(2), side(3)}};
  const Json& mapping = json.at("mapping");
  d.mapping = {mapping.at("x0"), mapping.at("y0"), mapping.at("dx"), mapping.at("dy")};
  if (!json.contains("crs")) {
    fail(Cause::unsupported,
         "an earlier Talus made this database, without the facts about its CRS: ingest the source again");
  }
  const Json& crs = json.at("crs");
  d.crs_wkt = crs.at("wkt");
  d.crs = {crs.at("name"),
           whole<int>(crs.at("epsg")),
           crs.at("geographic"),
           crs.at("metres_per_unit"),
           crs.at("degrees_per_unit"),
           crs.at("equatorial_radius"),
           crs.at("flattening")};
  d.source_name = json.at("source").at("name");
  d.source_type = json.at("source").at("type");
  d.vertical_unit = json.at("vertical").at("unit");
  d.metres_per_unit = json.at("vertical").at("metres_per_unit");
  const Json& step = json.at("step");
  d.step = {step.at("scale"), step.at("divisor"), step.at("offset"), step.at("integer")};
  const Json& heights = json.at("heights");
  d.minimum_height = heights.at("minimum");
  d.maximum_height = heights.at("maximum");
  d.void_samples = whole<std::uint64_t>(heights.at("void_samples"));
  const Json& errors = json.at("errors");
  d.void_weight = errors.at("void_weight");
  d.lossy = Metres{errors.at("lossy_bound")};
  d.finest_tolerance = Metres{errors.value("finest_tolerance", 0.0)};
  return d;
}

}  // namespace

Manifest decode_manifest(std::span<const std::byte> bytes) {
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const Json json = Json::parse(text, text + bytes.size(), nullptr, false);
  Manifest m;
  try {
    if (!json.is_object() || !json.contains("talus"))
      throw Failure(Cause::corrupt, "corrupt: header: this is not a Talus database");
    if (const int version = whole<int>(json.at("talus")); version != kFormatVersion) {
      fail(Cause::unsupported,
           "the database has format version {}, this program reads version {}: ingest the source again, or use the "
           "program that made it",
           version, kFormatVersion);
    }
    const Json& layout = json.at("layout");
    if (layout.at("band_levels") != kBandLevels || layout.at("page_side") != kPageSide) {
      fail(Cause::unsupported,
           "the database has pages of {} samples and bands of {} levels, this program reads {} and {}: ingest the "
           "source again, or use the program that made it",
           whole<int>(layout.at("page_side")), whole<int>(layout.at("band_levels")), kPageSide, kBandLevels);
    }
    const Json& errors = json.at("errors");
    if (errors.at("kind").get<std::string>() != kErrorKind) {
      fail(Cause::unsupported,
           "the database has errors of kind {}, this program reads exact ones: ingest the source again",
           errors.at("kind").dump());
    }
    const auto metric = error_metric_named(errors.at("metric").get<std::string>());
    if (!metric) {
      fail(Cause::unsupported,
           "the database has errors of metric {}, which this program does not know: use the program that made it",
           errors.at("metric").dump());
    }
    m.description = description_of(json);
    m.description.error_metric = *metric;
    m.bands = whole<int>(layout.at("bands"));
    m.generation = whole<std::uint32_t>(json.at("generation"));
    for (const Json& top : json.at("top_generations")) m.top_generations.push_back(whole<std::uint32_t>(top));
  } catch (const Json::exception& e) {
    fail(Cause::corrupt, "corrupt: header: {}", e.what());
  }
  require_plausible(m);
  return m;
}

std::vector<std::byte> encode(const Provenance& p) {
  Json sources = Json::array();
  for (const SourceFile& s : p.sources) {
    sources.push_back({{"name", s.name},
                       {"driver", s.driver},
                       {"type", s.type},
                       {"cols", s.cols},
                       {"rows", s.rows},
                       {"bytes", s.bytes},
                       {"xxh3", fmt::format("{:016x}", s.checksum)}});
  }
  Json above = Json::array();
  for (const auto& [tolerance, vertices] : p.vertices_above) above.push_back({tolerance, vertices});
  const Json json = {
      {"sources", sources}, {"made_by", p.made_by}, {"generation", p.generation}, {"vertices_above", above}};
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Provenance decode_provenance(std::span<const std::byte> bytes) {
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const Json json = Json::parse(text, text + bytes.size(), nullptr, false);
  Provenance p;
  try {
    for (const Json& s : json.at("sources")) {
      SourceFile source{s.at("name"),
                        s.at("driver"),
                        s.at("type"),
                        whole<std::int64_t>(s.at("cols")),
                        whole<std::int64_t>(s.at("rows")),
                        whole<std::uint64_t>(s.at("bytes")),
                        0};
      const std::string digits = s.at("xxh3");
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), source.checksum, 16);
      if (error != std::errc{} || end != digits.data() + digits.size())
        throw Failure(Cause::corrupt, "corrupt: provenance: a checksum is not a hexadecimal number");
      p.sources.push_back(std::move(source));
    }
    p.made_by = json.at("made_by");
    p.generation = whole<std::uint32_t>(json.at("generation"));
    for (const Json& pair : json.at("vertices_above"))
      p.vertices_above.emplace_back(pair.at(0).get<double>(), whole<std::uint64_t>(pair.at(1)));
  } catch (const Json::exception& e) {
    fail(Cause::corrupt, "corrupt: provenance: {}", e.what());
  }
  return p;
}

}  // namespace talus
