#include "engine/tile/tile_summary.hpp"

#include <cmath>
#include <cstring>

#include <zstd.h>

#include "talus/failure.hpp"

namespace talus {
namespace {

constexpr std::byte kVersion{2};

/// Runs `field` over every field in the order of the format, for writing and for reading.
template <class Summary, class Field>
void for_each_field(Summary& s, Field&& field) {
  for (auto& b : s.record.blocks) field(b.error);
  for (auto& b : s.record.blocks) field(b.holds);
  for (auto& b : s.record.blocks) field(b.has_data);
  for (auto& b : s.record.blocks) field(b.middle);
  for (auto& b : s.record.blocks) field(b.right);
  for (auto& b : s.record.blocks) field(b.down);
  for (auto& b : s.record.blocks) field(b.above);
  for (auto& b : s.record.blocks) field(b.below);
  for (auto& b : s.record.blocks) field(b.bits.finest);
  for (auto& b : s.record.blocks) field(b.bits.coarsest);
  for (auto& b : s.record.blocks) field(b.typical);
  for (auto& e : s.record.errors) field(e);
  for (auto& h : s.record.holds) field(h);
  for (auto& h : s.posts) field(h);
  for (auto& v : s.post_valid) field(v);
  field(s.entry.present);
  field(s.entry.largest);
  field(s.entry.lowest);
  field(s.entry.highest);
  field(s.entry.generation);
  field(s.valid_samples);
  field(s.lowest);
  field(s.highest);
  for (auto& n : s.errors) field(n);
}

[[noreturn]] void refuse(const char* what) {
  throw Failure(Cause::corrupt, std::string("corrupt: tile record: ") + what);
}

std::size_t plain_bytes() {
  static const std::size_t bytes = [] {
    std::size_t sum = 0;
    const TileSummary any;
    for_each_field(any, [&](const auto& v) { sum += sizeof v; });
    return sum;
  }();
  return bytes;
}

}  // namespace

double error_rung(std::size_t i) {
  if (i == 0) return 0;
  constexpr std::array kDigits{1.0, 2.0, 5.0};
  const int power = static_cast<int>((i - 1) / 3) - 3;
  const double digit = kDigits[(i - 1) % 3];
  return power < 0 ? digit / std::pow(10.0, -power) : digit * std::pow(10.0, power);
}

std::vector<std::byte> encode(const TileSummary& given) {
  TileSummary summary = given;
  // Which of two zeros is the lowest depends on the order of samples, so these have no sign. Posts are samples.
  for (auto& block : summary.record.blocks) block.typical += 0.0;
  summary.lowest += 0.0, summary.highest += 0.0;
  summary.entry.lowest += 0.0f, summary.entry.highest += 0.0f;
  std::vector<std::byte> plain(plain_bytes());
  std::byte* to = plain.data();
  for_each_field(summary, [&](const auto& v) {
    std::memcpy(to, &v, sizeof v);
    to += sizeof v;
  });
  std::vector<std::byte> bytes(1 + ZSTD_compressBound(plain.size()));
  bytes[0] = kVersion;
  const std::size_t size = ZSTD_compress(bytes.data() + 1, bytes.size() - 1, plain.data(), plain.size(), 3);
  if (ZSTD_isError(size) != 0) throw Failure(Cause::io, "zstd cannot compress a tile record");
  bytes.resize(1 + size);
  return bytes;
}

TileSummary decode_tile_summary(std::span<const std::byte> bytes) {
  if (bytes.empty() || bytes[0] != kVersion) refuse("its version is unknown");
  std::vector<std::byte> plain(plain_bytes());
  const std::size_t size = ZSTD_decompress(plain.data(), plain.size(), bytes.data() + 1, bytes.size() - 1);
  if (ZSTD_isError(size) != 0 || size != plain.size()) refuse("it cannot be unpacked");
  TileSummary summary;
  const std::byte* from = plain.data();
  for_each_field(summary, [&](auto& v) {
    if constexpr (std::is_same_v<decltype(v), bool&>) {
      if (*from > std::byte{1}) refuse("a flag is neither 0 nor 1");
    }
    std::memcpy(&v, from, sizeof v);
    from += sizeof v;
    if constexpr (std::is_same_v<decltype(v), double&> || std::is_same_v<decltype(v), float&>) {
      // The lowest and highest heights of a tile without data may be infinite. NaN is always wrong.
      if (std::isnan(v)) refuse("a number is NaN");
    }
  });
  return summary;
}

}  // namespace talus
