#include "storage/checksum.hpp"

#include <array>
#include <fstream>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <xxhash.h>

#include "talus/failure.hpp"

namespace talus {

std::uint64_t page_checksum(PageKey key, std::uint32_t generation, std::span<const std::byte> content) {
  std::array<std::uint8_t, 13> prefix{static_cast<std::uint8_t>(key.table)};
  for (std::size_t i = 0; i < 8; ++i) prefix[1 + i] = static_cast<std::uint8_t>(key.position >> (56 - 8 * i));
  for (std::size_t i = 0; i < 4; ++i) prefix[9 + i] = static_cast<std::uint8_t>(generation >> (8 * i));
  return XXH3_64bits_withSeed(content.data(), content.size(), XXH3_64bits(prefix.data(), prefix.size()));
}

std::uint64_t checksum_of_file(const std::filesystem::path& name, const std::function<void()>& tell) {
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  const std::unique_ptr<XXH3_state_t, Free> state{XXH3_createState()};
  if (!state) throw std::bad_alloc{};
  XXH3_64bits_reset(state.get());
  std::vector<char> buffer(std::size_t{4} << 20);
  std::ifstream file{name, std::ios::binary};
  while (file) {
    file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    XXH3_64bits_update(state.get(), buffer.data(), static_cast<std::size_t>(file.gcount()));
    tell();
  }
  if (!file.eof()) throw Failure(Cause::io, fmt::format("cannot read {}", name.string()), name);
  return XXH3_64bits_digest(state.get());
}

std::uint64_t checksum_of(std::span<const std::uint64_t> numbers) {
  std::vector<std::uint8_t> bytes;
  for (const std::uint64_t number : numbers) {
    for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
  }
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace talus
