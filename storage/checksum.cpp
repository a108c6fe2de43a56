#include "storage/checksum.hpp"

#include <array>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <xxhash.h>

#include "talus/failure.hpp"

namespace talus {

std::uint64_t page_checksum(PageKey key, std::span<const std::byte> content) {
  std::array<std::uint8_t, 9> prefix{static_cast<std::uint8_t>(key.table)};
  for (std::size_t i = 0; i < 8; ++i) prefix[1 + i] = static_cast<std::uint8_t>(key.position >> (56 - 8 * i));
  return XXH3_64bits_withSeed(content.data(), content.size(), XXH3_64bits(prefix.data(), prefix.size()));
}

std::uint64_t checksum_of_files(const std::vector<std::filesystem::path>& files) {
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  const std::unique_ptr<XXH3_state_t, Free> state{XXH3_createState()};
  if (!state) throw std::bad_alloc{};
  XXH3_64bits_reset(state.get());
  std::vector<char> buffer(1 << 20);
  for (const std::filesystem::path& name : files) {
    std::ifstream file{name, std::ios::binary};
    while (file) {
      file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
      XXH3_64bits_update(state.get(), buffer.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (!file.eof()) throw Failure(Cause::io, fmt::format("cannot read {}", name.string()));
  }
  return XXH3_64bits_digest(state.get());
}

}  // namespace talus
