#pragma once
// Lengths as one byte or more: seven bits each, the low ones first, the highest bit set in all but the last.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "talus/failure.hpp"

namespace talus {

inline void put_variable(std::vector<std::byte>& out, std::uint64_t value) {
  for (; value >= 128; value >>= 7) out.push_back(static_cast<std::byte>(value & 127) | std::byte{128});
  out.push_back(static_cast<std::byte>(value));
}

/// fails  corrupt: what is not there
class VariableReader {
 public:
  explicit VariableReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }
  [[nodiscard]] std::uint64_t value() {
    std::uint64_t v = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const auto byte = std::to_integer<std::uint64_t>(take(1)[0]);
      v |= (byte & 127) << shift;
      if (byte < 128) return v;
    }
    throw Failure(Cause::corrupt, "corrupt: a length of more than nine bytes");
  }
  [[nodiscard]] std::size_t size() { return static_cast<std::size_t>(value()); }
  [[nodiscard]] std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size()) throw Failure(Cause::corrupt, "corrupt: a length beyond the bytes");
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace talus
