// One window by Talus and by GDAL, and the judge of meshes, a question a line: peers.py asks, and asks martini by
// turns.
//
//   peers MODEL COL ROW FOLDER     the window of 1025² samples whose north-west sample is (COL, ROW)
//
// Warm: the file is in the system's cache, and neither side keeps anything decoded. Each answer is one line of numbers;
// a time is two: milliseconds of processor time, and by the clock.
//
//   memcpy               time of copying 64 MiB
//   talus METRES         time to the indexed mesh, vertices, triangles
//   lerc METRES          time of reading the window from a GeoTIFF of LERC_ZSTD with so large a MAX_Z_ERROR
//   float                the same of MAX_Z_ERROR 0 as 32-bit floats, which martini takes
//   export FILE          writes these floats; a void has the height of the sample before it. Returns how many were void
//   judge METRES         the true error of Talus's mesh
//   judge_file FILE      the true error of the mesh that martini.cjs wrote

#include <chrono>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gdal_priv.h>
#include <gdal_utils.h>

#include "bench/kept.hpp"
#include "query/accuracy/true_error.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"

namespace talus::bench {
namespace {

namespace fs = std::filesystem;
constexpr int kSide = 1025, kAround = 512;  ///< samples on each side of the window that GDAL's file has, too

/// Of processor time, and by the clock.
template <class Work>
std::string milliseconds(Work&& work) {
  const auto begun = std::chrono::steady_clock::now();
  const auto worked = std::clock();
  work();
  const double processor = 1000.0 * static_cast<double>(std::clock() - worked) / CLOCKS_PER_SEC;
  return fmt::format("{} {}", processor,
                     std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count());
}

class Peers {
 public:
  Peers(const fs::path& model, GridPoint first, fs::path folder)
      : model_(model),
        window_{first, {first.col + kSide - 1, first.row + kSide - 1}},
        folder_(std::move(folder)),
        now_(Database::open(kept_database(model.stem().string(), [&] { return model; }),
                            {.cache_bytes = 0, .threads = 1})
                 .snapshot()),
        truth_(model) {
    GDALAllRegister();
  }

  std::string answer(const std::string& verb, const std::string& rest) {
    if (verb == "memcpy") return copy();
    if (verb == "talus") return talus(Metres{std::stod(rest)});
    if (verb == "lerc") return lerc(rest);
    if (verb == "float") return read("0", GDT_Float32, floats_);
    if (verb == "export") return write_floats(rest);
    if (verb == "judge")
      return judge(triangulate(now_.ask({.region = window_, .tolerance = Metres{std::stod(rest)}}).quadtree, 1));
    if (verb == "judge_file") return judge(mesh_of(rest));
    throw Failure(Cause::invalid_argument, "no such question: " + verb);
  }

 private:
  std::string copy() {
    std::memcpy(to_.data(), from_.data(), from_.size());  // the first time is no measure
    return milliseconds([&] { std::memcpy(to_.data(), from_.data(), from_.size()); });
  }

  std::string talus(Metres tolerance) const {
    std::size_t vertices = 0, triangles = 0;
    const std::string time = milliseconds([&] {
      const Mesh mesh = triangulate(now_.ask({.region = window_, .tolerance = tolerance}).quadtree, 1);
      vertices = mesh.points.size();
      triangles = mesh.triangles.size();
    });
    return fmt::format("{} {} {}", time, vertices, triangles);
  }

  std::string lerc(const std::string& largest_error) {
    GDALRasterBand& band = lerc_band(largest_error);
    std::vector<char> room(std::size_t{kSide} * kSide *
                           static_cast<std::size_t>(GDALGetDataTypeSizeBytes(band.GetRasterDataType())));
    return read(largest_error, band.GetRasterDataType(), room);
  }

  template <class Room>
  std::string read(const std::string& largest_error, GDALDataType type, Room& room) {
    GDALRasterBand& band = lerc_band(largest_error);
    band.FlushCache(false);  // and drops the decoded blocks
    CPLErr code = CE_None;
    const std::string time = milliseconds([&] {
      code = band.RasterIO(GF_Read, offset(window_.first.col), offset(window_.first.row), kSide, kSide, room.data(),
                           kSide, kSide, type, 0, 0, nullptr);
    });
    if (code != CE_None) throw Failure(Cause::io, "GDAL cannot read its window");
    return time;
  }

  /// GDAL's file holds the window and something around it; its blocks of 256² lie on the raster's.
  [[nodiscard]] static int offset(std::int32_t v) { return v - begin(v); }
  [[nodiscard]] static int begin(std::int32_t v) { return std::max(0, v - kAround) / 256 * 256; }

  GDALRasterBand& lerc_band(const std::string& largest_error) {
    auto& dataset = lerc_[largest_error];
    if (!dataset) dataset.reset(GDALDataset::FromHandle(make_lerc(largest_error)));
    return *dataset->GetRasterBand(1);
  }

  GDALDatasetH make_lerc(const std::string& largest_error) {
    const fs::path file = folder_ / fmt::format("{}_{}.tif", model_.stem().string(), largest_error);
    if (fs::exists(file)) return opened(file);
    CPLStringList words;
    const auto corner =
        fmt::format("-srcwin {} {} {} {}", begin(window_.first.col), begin(window_.first.row),
                    offset(window_.first.col) + kSide + kAround, offset(window_.first.row) + kSide + kAround);
    for (const std::string& list :
         {corner,
          std::string("-q -of GTiff -co TILED=YES -co BLOCKXSIZE=256 -co BLOCKYSIZE=256 -co COMPRESS=LERC_ZSTD"),
          "-co MAX_Z_ERROR=" + largest_error}) {
      std::istringstream stream(list);
      for (std::string word; stream >> word;) words.AddString(word.c_str());
    }
    GDALTranslateOptions* options = GDALTranslateOptionsNew(words.List(), nullptr);
    GDALDatasetH from = GDALOpen(model_.c_str(), GA_ReadOnly);
    GDALDatasetH made = from == nullptr ? nullptr : GDALTranslate(file.c_str(), from, options, nullptr);
    GDALTranslateOptionsFree(options);
    if (made != nullptr) GDALClose(made);
    if (from != nullptr) GDALClose(from);
    return opened(file);
  }
  static GDALDatasetH opened(const fs::path& file) {
    GDALDatasetH dataset = GDALOpen(file.c_str(), GA_ReadOnly);
    if (dataset == nullptr) throw Failure(Cause::io, fmt::format("{}: {}", file.string(), CPLGetLastErrorMsg()));
    return dataset;
  }

  struct Filled {
    std::vector<float> heights;
    std::size_t voids = 0;
  };
  /// What martini is given, which knows no voids.
  [[nodiscard]] Filled filled() const {
    const SampleWindow samples = truth_.read(window_);
    Filled all;
    float last = 0;
    for (std::size_t i = 0; i < samples.values.size(); ++i) {
      if (samples.valid[i] != 0) {
        last = static_cast<float>(samples.values[i]);
      } else {
        ++all.voids;
      }
      all.heights.push_back(last);
    }
    return all;
  }

  [[nodiscard]] std::string write_floats(const std::string& file) const {
    const Filled all = filled();
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(all.heights.data()),
               static_cast<std::streamsize>(all.heights.size() * sizeof(float)));
    return fmt::format("{}", all.voids);
  }

  /// Counts of vertices and triangles in 32 bits, then columns and rows in 16, then triangles in 32.
  [[nodiscard]] Mesh mesh_of(const std::string& name) const {
    std::ifstream file(name, std::ios::binary);
    std::uint32_t counts[2] = {};
    file.read(reinterpret_cast<char*>(counts), sizeof counts);
    std::vector<std::uint16_t> places(std::size_t{2} * counts[0]);
    file.read(reinterpret_cast<char*>(places.data()), static_cast<std::streamsize>(places.size() * sizeof places[0]));
    Mesh mesh;
    mesh.region = window_;
    mesh.triangles.resize(counts[1]);
    file.read(reinterpret_cast<char*>(mesh.triangles.data()),
              static_cast<std::streamsize>(mesh.triangles.size() * sizeof mesh.triangles[0]));
    if (!file) throw Failure(Cause::io, name + ": no mesh");
    const Filled all = filled();
    for (std::size_t i = 0; i < counts[0]; ++i) {
      const std::int32_t col = places[2 * i], row = places[2 * i + 1];
      mesh.points.push_back({window_.first.col + col, window_.first.row + row});
      mesh.heights.push_back(all.heights[static_cast<std::size_t>(row * kSide + col)]);
    }
    return mesh;
  }

  /// Largest error, and covered samples that no triangle touches.
  [[nodiscard]] std::string judge(const Mesh& mesh) const {
    const TrueError found = true_error(mesh, now_.description(), [&](GridRect part) { return truth_.read(part); });
    return fmt::format("{} {}", found.largest_m, found.uncovered);
  }

  fs::path model_;
  GridRect window_;
  fs::path folder_;
  Snapshot now_;
  Raster truth_;
  std::map<std::string, std::unique_ptr<GDALDataset>> lerc_;
  std::vector<float> floats_ = std::vector<float>(std::size_t{kSide} * kSide);
  std::vector<char> from_ = std::vector<char>(std::size_t{64} << 20, 1), to_ = from_;
};

}  // namespace
}  // namespace talus::bench

int main(int count, char** words) try {
  if (count != 5) throw talus::Failure(talus::Cause::invalid_argument, "peers MODEL COL ROW FOLDER");
  talus::bench::Peers peers(words[1], {std::stoi(words[2]), std::stoi(words[3])}, words[4]);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream stream(line);
    std::string verb, rest;
    stream >> verb >> rest;
    std::cout << peers.answer(verb, rest) << std::endl;
  }
  return 0;
} catch (const std::exception& e) {
  std::cerr << "peers: " << e.what() << '\n';
  return 1;
}
