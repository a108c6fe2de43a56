#pragma once
// What the candidates of a level are, as bytes. docs/format/rqt-v1.md, section 7.
//
// Rows of a level are cut into stripes, of about as many rows each. Stripes are coded apart, so that several threads can
// take them; what is expected of a candidate does not depend on its stripe.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/stream/level_walk.hpp"

namespace talus {

/// First row of a stripe; of `stripes`, one past the last row.
[[nodiscard]] constexpr std::int32_t stripe_row(std::int32_t rows, std::size_t stripes, std::size_t stripe) {
  return static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * static_cast<std::int64_t>(stripe) /
                                   static_cast<std::int64_t>(stripes));
}

/// What a walk told of one stripe of half a level.
template <class Code>
struct StripeRecord {
  std::vector<std::size_t> rows;  ///< candidates of each
  std::vector<std::uint8_t> contexts, present;
  std::vector<Code> residuals;  ///< of absent ones: 0

  void take(const CandidateRow<Code>& row);
};

/// Tables may serve the next level, too.
struct SymbolState;

template <class Code>
class LevelEncoder {
 public:
  LevelEncoder();
  ~LevelEncoder();
  LevelEncoder(const LevelEncoder&) = delete;
  LevelEncoder& operator=(const LevelEncoder&) = delete;
  /// halves  centres and sides: a record for each stripe
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
  /// The bytes of the next level; they must stay. Returns the number of stripes.
  /// fails  corrupt: anything they cannot be
  [[nodiscard]] std::size_t start(std::span<const std::byte> bytes);
  /// Tells what the candidates of a row are. Stripes may be taken by several threads, the rows of each in order, the
  /// centres of all before any sides.
  void take(std::size_t half, std::size_t stripe, CandidateRow<Code>& row);
  /// Whether each stripe was read to its end.
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
