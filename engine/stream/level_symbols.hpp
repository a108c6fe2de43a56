#pragma once
// Codes which candidates of a level are vertices, and their residuals. docs/format/rqt-v1.md, section 7.
//
// A level is cut into stripes of about the same number of rows. Each stripe is coded alone, so several threads can work
// at once. The prediction of a candidate does not depend on its stripe.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/stream/level_walk.hpp"

namespace talus {

/// First row of a stripe. For stripe = stripes, one past the last row.
[[nodiscard]] constexpr std::int32_t stripe_row(std::int32_t rows, std::size_t stripes, std::size_t stripe) {
  return static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * static_cast<std::int64_t>(stripe) /
                                   static_cast<std::int64_t>(stripes));
}

/// The candidates of one stripe of half a level, as a walk found them.
template <class Code>
struct StripeRecord {
  std::vector<std::size_t> rows;  ///< number of candidates in each row
  std::vector<std::uint8_t> contexts, present;
  std::vector<Code> residuals;  ///< 0 for absent candidates

  void take(const CandidateRow<Code>& row);
};

/// The tables of symbols, which the next level may use again.
struct SymbolState;

template <class Code>
class LevelEncoder {
 public:
  LevelEncoder();
  ~LevelEncoder();
  LevelEncoder(const LevelEncoder&) = delete;
  LevelEncoder& operator=(const LevelEncoder&) = delete;
  /// halves  centres, then side midpoints: a record for each stripe
  [[nodiscard]] std::vector<std::byte> encode(std::array<std::vector<StripeRecord<Code>>, 2> const& halves);

 private:
  std::unique_ptr<SymbolState> state_;
};

template <class Code>
class LevelDecoder {
 public:
  LevelDecoder();
  ~LevelDecoder();
  LevelDecoder(const LevelDecoder&) = delete;
  LevelDecoder& operator=(const LevelDecoder&) = delete;
  /// Begins the next level, and returns its number of stripes. `bytes` must live as long as the level is decoded.
  /// fails  corrupt: no writer makes such bytes
  [[nodiscard]] std::size_t start(std::span<const std::byte> bytes);
  /// Decodes the candidates of a row. Several threads may decode stripes at once. The rows of a stripe come in order,
  /// and the centres of all stripes before any side midpoints.
  void take(std::size_t half, std::size_t stripe, CandidateRow<Code>& row);
  /// Whether each stripe was read exactly to its end.
  [[nodiscard]] bool is_intact() const;

  struct Stripe;

 private:
  std::unique_ptr<SymbolState> state_;
  std::array<std::vector<std::unique_ptr<Stripe>>, 2> stripes_;
};

extern template class LevelEncoder<std::int32_t>;
extern template class LevelEncoder<std::int64_t>;
extern template class LevelDecoder<std::int32_t>;
extern template class LevelDecoder<std::int64_t>;

}  // namespace talus
