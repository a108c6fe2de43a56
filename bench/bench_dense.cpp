// How fast are the kernels of dense pages: numbers from bytes, errors from heights, and the bits above a threshold? On one
// core, whole metres, with the kernel that TALUS_KERNEL names. Each rate is samples of whole pages.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <gdal_priv.h>

#include "bench/terrain.hpp"
#include "bench/yardstick.hpp"
#include "engine/dense/dense_numbers.hpp"
#include "engine/dense/kernels.hpp"
#include "engine/page/stored_errors.hpp"

namespace talus {
namespace {

using detail::SortedSquare;

constexpr int kSide = detail::kDenseSide, kAcross = 8;  // pages along a side of the ground

/// Pages of one ground, and what the reader of each knows before.
struct Pages {
  std::vector<std::vector<std::uint16_t>> squares, known;
  std::vector<std::vector<std::byte>> numbers;
  StoredErrors border;

  Pages() {
    const std::vector<double> ground = bench::mountains(kAcross * kSide);
    Page page;
    page.grid = page_grid({}, {{0, 0}, {kSide - 1, kSide - 1}});
    border.list(page, ErrorForm::dense);
    DenseNumbers<std::uint16_t> writer;
    for (int y = 0; y < kAcross; ++y) {
      for (int x = 0; x < kAcross; ++x) add(ground, x, y, writer);
    }
  }

 private:
  void add(const std::vector<double>& ground, int x, int y, DenseNumbers<std::uint16_t>& writer) {
    std::vector<std::uint16_t> square(kSquare), coarse(kSquare, 0);
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) {
        const auto at = static_cast<std::size_t>((y * kSide + row) * kAcross * kSide + x * kSide + col);
        const auto i = static_cast<std::size_t>(row * kSide + col);
        square[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(ground[at]));
        if (((col | row) & 7) == 0) coarse[i] = square[i];
      }
    }
    std::vector<std::byte> bytes;
    writer.put(square, nullptr, bytes);
    squares.push_back(std::move(square));
    known.push_back(std::move(coarse));
    numbers.push_back(std::move(bytes));
  }
};
const Pages& pages() {
  static const Pages p;
  return p;
}

/// What a page is read into.
struct Room {
  DenseSquares squares{};
  SortedSquare memory{};
  std::uint64_t rows[kSide][2] = {};

  void know(std::size_t page) {
    for (std::size_t row = 0; row < kSide; row += 8) {
      for (std::size_t col = 0; col < kSide; col += 8)
        square()[row * kSide + col] = pages().known[page][row * kSide + col];
    }
  }
  [[nodiscard]] std::span<std::uint16_t> square() {
    return {reinterpret_cast<std::uint16_t*>(squares.numbers), kSquare};
  }
};

/// Calls step(room, page) for one page after the other.
template <class Step>
void over_pages(benchmark::State& state, Step&& step) {
  const auto room = std::make_unique<Room>();
  std::size_t page = 0;
  for (auto _ : state) {
    step(*room, page);
    benchmark::ClobberMemory();
    page = (page + 1) % pages().squares.size();
  }
  state.counters["samples/s"] =
      benchmark::Counter(static_cast<double>(kSquare), benchmark::Counter::kIsIterationInvariantRate);
}

void BM_ReadNumbers(benchmark::State& state) {
  DenseNumbers<std::uint16_t> reader;
  over_pages(state, [&](Room& room, std::size_t page) {
    room.know(page);
    if (!reader.get(pages().numbers[page], nullptr, room.square())) state.SkipWithError("the numbers are damaged");
  });
}
BENCHMARK(BM_ReadNumbers);

void BM_WriteNumbers(benchmark::State& state) {
  DenseNumbers<std::uint16_t> writer;
  std::vector<std::byte> bytes;
  double written = 0, numbers = 0;
  over_pages(state, [&](Room&, std::size_t page) {
    std::vector<std::uint16_t> square = pages().squares[page];
    bytes.clear();
    writer.put(square, nullptr, bytes);
    written += static_cast<double>(bytes.size());
    numbers += detail::kDenseNumbers;
  });
  state.counters["bits/number"] = 8 * written / numbers;
}
BENCHMARK(BM_WriteNumbers);

void BM_ErrorsOfHeights(benchmark::State& state) {
  const detail::EighthsKernel& kernel = detail::eighths_kernel(instruction_set());
  over_pages(state, [&](Room& room, std::size_t page) {
    kernel.compute(reinterpret_cast<const std::int16_t*>(pages().squares[page].data()), room.squares.errors,
                   room.memory);
  });
}
BENCHMARK(BM_ErrorsOfHeights);

void BM_Select(benchmark::State& state) {
  const detail::EighthsKernel& kernel = detail::eighths_kernel(instruction_set());
  over_pages(state, [&](Room& room, std::size_t page) {
    if (page == 0)
      kernel.compute(reinterpret_cast<const std::int16_t*>(pages().squares[0].data()), room.squares.errors,
                     room.memory);
    benchmark::DoNotOptimize(kernel.select(room.squares.errors, 40, {}, room.rows));
  });
}
BENCHMARK(BM_Select);

/// From bytes to the bits of all vertices above 5 m.
void BM_BytesToBits(benchmark::State& state) {
  const detail::EighthsKernel& kernel = detail::eighths_kernel(instruction_set());
  DenseNumbers<std::uint16_t> reader;
  over_pages(state, [&](Room& room, std::size_t page) {
    room.know(page);
    bool whole = reader.get(pages().numbers[page], nullptr, room.square());
    kernel.compute(room.squares.numbers, room.squares.errors, room.memory);
    constexpr std::array<std::byte, 1> kLeast{};  // the others are the least possible errors
    whole = pages().border.get(kLeast, room.squares, nullptr) && whole;
    if (!whole) state.SkipWithError("the page is damaged");
    benchmark::DoNotOptimize(kernel.select(room.squares.errors, 40, {}, room.rows));
  });
}
BENCHMARK(BM_BytesToBits);

/// Whole pages of a real model, whose samples are all data.
std::vector<std::vector<std::uint16_t>> pages_of_model(const char* name) {
  std::vector<std::vector<std::uint16_t>> squares;
  const auto file = bench::real_model(name);
  if (!file) return squares;
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> raster(GDALDataset::Open(file->c_str(), GDAL_OF_RASTER));
  GDALRasterBand* band = raster->GetRasterBand(1);
  const double none = band->GetNoDataValue();
  for (int y = 0; y + kSide <= band->GetYSize(); y += kSide) {
    for (int x = 0; x + kSide <= band->GetXSize(); x += kSide) {
      std::vector<std::int16_t> heights(kSquare);
      if (band->RasterIO(GF_Read, x, y, kSide, kSide, heights.data(), kSide, kSide, GDT_Int16, 0, 0) != CE_None)
        continue;
      const bool whole = std::none_of(heights.begin(), heights.end(), [&](std::int16_t h) { return h == none; });
      if (whole) squares.emplace_back(heights.begin(), heights.end());
    }
  }
  return squares;
}

/// Reads the pages of a model, and says what they take.
void BM_RealModel(benchmark::State& state, const char* name) {
  const std::vector<std::vector<std::uint16_t>> squares = pages_of_model(name);
  if (squares.empty()) return state.SkipWithError("no such model here: set TALUS_DEM_DIR");
  DenseNumbers<std::uint16_t> numbers;
  std::vector<std::vector<std::byte>> written(squares.size());
  double bytes = 0;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    std::vector<std::uint16_t> square = squares[i];
    numbers.put(square, nullptr, written[i]);
    bytes += static_cast<double>(written[i].size());
  }
  std::vector<std::uint16_t> square(kSquare);
  for (auto _ : state) {
    for (std::size_t i = 0; i < squares.size(); ++i) {
      for (std::size_t row = 0; row < kSide; row += 8) {
        for (std::size_t col = 0; col < kSide; col += 8) square[row * kSide + col] = squares[i][row * kSide + col];
      }
      if (!numbers.get(written[i], nullptr, square) || square != squares[i]) state.SkipWithError("it is not lossless");
    }
  }
  const auto pages = static_cast<double>(squares.size());
  state.counters["bits/number"] = 8 * bytes / (pages * detail::kDenseNumbers);
  state.counters["samples/s"] = benchmark::Counter(pages * kSquare, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(BM_RealModel, srtm3_N47E007, "swiss_germany_3s/srtm3_N47E007.tif")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_RealModel, srtm3_S36E149, "srtm3_S36E149.tif")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_RealModel, kenya_central_z11, "kenya_central_z11.tif")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace talus
