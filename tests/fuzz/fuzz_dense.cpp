// Arbitrary bytes as the numbers of a dense page: all kernels refuse them, or all read the same numbers, which are
// written and read again.
//
// The first byte chooses the width of the numbers and which of them are stored.

#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "engine/dense/dense_numbers.hpp"
#include "engine/dense/dense_plain.hpp"
#include "engine/dense/kernels.hpp"

namespace {

using namespace talus;

constexpr std::size_t kSquare = std::size_t{detail::kDenseSide} * detail::kDenseSide;

void require(bool holds) {
  if (!holds) std::abort();
}

/// Half of the choices: the south-east and some columns are missing.
SquareBits stored_numbers(unsigned choice) {
  SquareBits stored{};
  for (int row = 0; row < detail::kDenseSide; ++row) {
    for (int col = 0; col < detail::kDenseSide; ++col) {
      if (row + col < static_cast<int>(4 * choice) && (col & 3) != static_cast<int>(choice & 7))
        insert(stored, col, row);
    }
  }
  return stored;
}

template <class T>
void read_by_all(std::span<const std::byte> bytes, const SquareBits* stored) {
  std::vector<T> square(kSquare, 77);
  const bool verdict = DenseNumbers<T>(detail::kPlainDense<T>).get(bytes, stored, square);
  for (const InstructionSet set : instruction_sets_here()) {
    std::vector<T> again(kSquare, 77);
    require(DenseNumbers<T>(detail::dense_functions<T>(set)).get(bytes, stored, again) == verdict);
    require(!verdict || again == square);
  }
  if (!verdict) return;
  std::vector<std::byte> written;
  std::vector<T> back(kSquare, 77), original = square;
  DenseNumbers<T> numbers;
  numbers.put(square, stored, written);
  require(square == original && numbers.get(written, stored, back) && back == square);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = data[0] / 3;
  const SquareBits some = stored_numbers(choice / 2);
  const SquareBits* stored = choice % 2 == 0 ? nullptr : &some;
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  switch (data[0] % 3) {
    case 0: read_by_all<std::uint16_t>(bytes, stored); break;
    case 1: read_by_all<std::uint32_t>(bytes, stored); break;
    default: read_by_all<std::uint64_t>(bytes, stored);
  }
  return 0;
}
