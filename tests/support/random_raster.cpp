#include "tests/support/random_raster.hpp"

#include <cstdlib>
#include <limits>

namespace talus::support {
namespace {

/// Small sizes as likely as large ones, and often one beside a power of two.
int random_size(Random& random, int least, int most) {
  int size = static_cast<int>(random.log_between(least, most + 0.999));
  if (random.chance(0.3)) {
    int power = 1;
    while (2 * power < size) power *= 2;
    size = power + random.between(-1, 2);
  }
  return std::clamp(size, least, most);
}

Terrain random_surface(Random& random, int cols, int rows, std::string& said) {
  const int kind = random.between(0, 10);
  const std::uint64_t seed = random.next();
  static const char* const names[] = {"plane",   "spike", "pit",      "diagonal ridge", "cross ridge", "sine hills",
                                      "fractal", "cliff", "plateaus", "checkerboard",   "noise"};
  said += names[kind];
  const int col = random.between(0, cols - 1), row = random.between(0, rows - 1);
  switch (kind) {
    case 0: return plane(cols, rows, random.between(0, 500), random.between(-4, 4), random.within(-3, 3));
    case 1: return spike(cols, rows, col, row, random.within(1, 200));
    case 2: return pit(cols, rows, col, row, random.within(1, 90));
    case 3: return diagonal_ridge(cols, rows, random.within(0.25, 4));
    case 4: return cross_ridge(cols, rows, random.within(0.25, 4));
    case 5: return sine_hills(cols, rows, random.log_between(1, 400), random.log_between(3, 100));
    case 6: return fractal(cols, rows, seed, random.log_between(5, 3000), random.within(0.4, 0.75));
    case 7: return cliff(cols, rows, random.within(1, 900));
    case 8: return plateaus(cols, rows, random.between(1, 40));
    case 9: return checkerboard(cols, rows, -32767, 32767);
    default: return noise(cols, rows, seed, 0, random.log_between(1, 5000));
  }
}

Terrain with_voids(Random& random, Terrain terrain, std::string& said) {
  const Terrain whole = terrain;
  const std::uint64_t seed = random.next();
  const int col = random.between(-10, terrain.cols), row = random.between(-10, terrain.rows);
  switch (random.between(0, 9)) {
    case 0: terrain = random_voids(terrain, random.log_between(0.001, 0.9), seed), said += ", random voids"; break;
    case 1: terrain = void_blobs(terrain, random.between(1, 6), seed), said += ", void blobs"; break;
    case 2:
      terrain = void_diagonals(terrain, random.between(2, 40), random.between(0, 9)), said += ", void lines";
      break;
    case 3:
      terrain = hole(terrain, col, row, col + random.between(0, 60), row + random.between(0, 60)), said += ", hole";
      break;
    case 4: terrain = hole(terrain, 0, 0, random.between(0, terrain.cols), terrain.rows), said += ", half void"; break;
    default: break;
  }
  return terrain.has_data() ? terrain : whole;
}

/// What instruments write: whole metres, decimetres, eighths, or every bit.
void quantise(Random& random, Terrain& terrain, SampleType type, std::string& said) {
  if (type == SampleType::int32) {
    const int factor = random.between(1, 20);  // beyond 16 bits, within a million metres
    for (double& value : terrain.values) value *= factor;
    said += ", times " + std::to_string(factor);
  }
  if (type != SampleType::float32 && type != SampleType::float64) return;
  static const double divisors[] = {1, 10, 100, 1000, 8};
  const int kind = random.between(0, 7);
  if (kind > 4) return;
  for (double& value : terrain.values) {
    value = std::round(value * divisors[kind]) / divisors[kind];
    if (value == 0 && random.chance(0.5)) value = -0.0;
  }
  said += ", steps of 1/" + std::to_string(static_cast<int>(divisors[kind]));
}

void choose_ground(Random& random, RandomRaster& raster) {
  switch (random.between(0, 3)) {
    case 0: {
      const double cell = random.between(1, 90);
      raster.file.crs = "EPSG:32632";
      raster.file.geotransform = {450000, cell, 0, 5200000, 0, -cell};
      raster.judging.cell_width_m = raster.judging.cell_height_m = cell;
      raster.description += ", UTM " + std::to_string(static_cast<int>(cell)) + " m";
      break;
    }
    case 1:
      raster.file.crs = "EPSG:4326";
      raster.file.geotransform = {8, 1 / 1200.0, 0, 47, 0, -1 / 1200.0};
      raster.description += ", degrees";
      break;
    default: raster.judging.cell_width_m = raster.judging.cell_height_m = 1; break;
  }
  if (random.chance(0.1)) raster.file.unit = "ft", raster.description += ", feet";
}

}  // namespace

RandomRaster random_raster(std::uint64_t seed, SizeLimits limits) {
  Random random(seed);
  RandomRaster raster;
  int cols = random_size(random, limits.least_cols, limits.most_cols);
  const int rows = random_size(random, limits.least_rows, limits.most_rows);
  if (cols == 1 && rows == 1) cols = 2;
  raster.file.type = static_cast<SampleType>(random.between(0, 6));
  raster.description = "seed " + std::to_string(seed) + ": " + std::to_string(cols) + " x " + std::to_string(rows) +
                       " " + to_string(raster.file.type) + ", ";
  Terrain terrain = random_surface(random, cols, rows, raster.description);
  quantise(random, terrain, raster.file.type, raster.description);
  raster.terrain = fit(with_voids(random, fit(terrain, raster.file.type), raster.description), raster.file.type);
  const bool is_float = raster.file.type == SampleType::float32 || raster.file.type == SampleType::float64;
  if (is_float && random.chance(0.5)) raster.file.nodata = std::numeric_limits<double>::quiet_NaN();
  if (raster.file.type == SampleType::uint8) {  // all of 256 values may be in use
    raster.file.nodata.reset();
    for (std::size_t i = 0; i < raster.terrain.values.size(); ++i) {
      if (raster.terrain.values[i] == 0) raster.terrain.values[i] = 1;
    }
  }
  choose_ground(random, raster);
  static const double weights[] = {1, 1, 1, 0.25, 3};
  raster.void_weight = raster.judging.void_weight = weights[random.between(0, 4)];
  return raster;
}

GridRect random_region(Random& random, const Terrain& terrain) {
  if (random.chance(0.3)) return {{0, 0}, {terrain.cols - 1, terrain.rows - 1}};
  int west = random.between(0, terrain.cols - 1), east = random.between(0, terrain.cols - 1);
  int north = random.between(0, terrain.rows - 1), south = random.between(0, terrain.rows - 1);
  if (west > east) std::swap(west, east);
  if (north > south) std::swap(north, south);
  if (random.chance(0.2)) west = west / 16 * 16, north = north / 16 * 16;
  return {{west, north}, {east, south}};
}

double random_tolerance(Random& random) {
  switch (random.between(0, 7)) {
    case 0: return 0;
    case 1: return std::numeric_limits<double>::infinity();
    case 2: return random.between(1, 50);
    case 3: return random.between(1, 80) / 8.0;
    case 4: return random.between(1, 80) / 10.0;
    default: return random.log_between(0.001, 1000);
  }
}

int property_cases(int usual) {
  const char* cases = std::getenv("TALUS_PROPERTY_CASES");
  if (cases == nullptr) return usual;
  return std::max(1, static_cast<int>(std::int64_t{usual} * std::atoi(cases) / 1000));
}

std::optional<std::uint64_t> property_seed() {
  const char* seed = std::getenv("TALUS_PROPERTY_SEED");
  if (seed == nullptr) return std::nullopt;
  return std::strtoull(seed, nullptr, 10);
}

}  // namespace talus::support
