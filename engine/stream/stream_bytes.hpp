#pragma once
// Writes and reads the numbers of a stream as little-endian bytes, with checksums.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "talus/units.hpp"

namespace talus {

/// The XXH3 checksum of 64 bits.
[[nodiscard]] std::uint64_t stream_checksum(std::span<const std::byte> bytes, std::uint64_t seed);

class StreamWriter {
 public:
  template <class T>
  void put(T value) {
    auto raw = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  }
  void put(GridRect r) {
    for (const std::int32_t v : {r.first.col, r.first.row, r.last.col, r.last.row}) put(v);
  }
  void put(const std::string& text) {
    const auto raw = std::as_bytes(std::span(text));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  }
  void put(std::span<const std::byte> raw) { bytes.insert(bytes.end(), raw.begin(), raw.end()); }
  /// Appends a checksum of the bytes from `begin` on. Its seed is the checksum before it.
  void seal(std::size_t begin) {
    seed_ = stream_checksum(std::span(bytes).subspan(begin), seed_);
    put(seed_);
  }
  /// The same, but appends only the low half of the checksum.
  void seal_short(std::size_t begin) {
    seed_ = stream_checksum(std::span(bytes).subspan(begin), seed_);
    put(static_cast<std::uint32_t>(seed_));
  }
  std::vector<std::byte> bytes;

 private:
  std::uint64_t seed_ = 0;
};

/// Reads numbers one after the other. Missing bytes are corrupt. origin: the place of `bytes` in the stream.
class StreamTaker {
 public:
  explicit StreamTaker(std::span<const std::byte> bytes, std::size_t origin = 0) : bytes_(bytes), origin_(origin) {}

  [[noreturn]] static void refuse(std::size_t at, const std::string& what) {
    fail(Cause::corrupt, "corrupt: byte {}: {}", at, what);
  }
  [[noreturn]] void refuse(const std::string& what) const { refuse(origin_ + at_, what); }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  void require(std::uint64_t count) const {
    if (count > left())
      refuse(origin_ + bytes_.size(), fmt::format("the stream is cut: {} more bytes are expected", count - left()));
  }
  template <class T>
  T take() {
    require(sizeof(T));
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }
  GridRect rect() {
    GridRect r;
    for (std::int32_t* v : {&r.first.col, &r.first.row, &r.last.col, &r.last.row}) *v = take<std::int32_t>();
    return r;
  }
  std::span<const std::byte> take(std::uint64_t count) {
    require(count);
    const auto taken = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += taken.size();
    return taken;
  }
  std::string text(std::uint64_t count) {
    const auto raw = take(count);
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t origin_, at_ = 0;
};

/// Writes a length in bytes of seven bits, low bits first. All bytes but the last have the highest bit set.
inline void put_variable(std::vector<std::byte>& out, std::uint64_t value) {
  for (; value >= 128; value >>= 7) out.push_back(static_cast<std::byte>(value & 127) | std::byte{128});
  out.push_back(static_cast<std::byte>(value));
}

/// Reads such lengths, and the bytes that follow them.
/// fails  corrupt: missing bytes
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
    throw Failure(Cause::corrupt, "corrupt: a length has more than nine bytes");
  }
  [[nodiscard]] std::size_t size() { return static_cast<std::size_t>(value()); }
  [[nodiscard]] std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size()) throw Failure(Cause::corrupt, "corrupt: a length exceeds the bytes that follow");
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace talus
