#pragma once
// The smallest profile: each candidate told by yes-or-no decisions, each with a chance that several adaptive models
// agree on. Slower by far than tables of symbols: what was told before, also in the same half of a level, sharpens what
// is expected next. All in whole numbers, so that every machine has the same. docs/format/rqt-v1.md, section 9.
//
// source  logistic mixing of predictions, M. Mahoney, "Adaptive Weighing of Context Models for Lossless Data
//         Compression", Florida Tech. report CS-2005-16

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/stream/level_walk.hpp"

namespace talus {

/// What the decisions so far have taught, of one stripe. Levels go on with it.
class MixedModel;
struct MixedModelDelete {
  void operator()(MixedModel* model) const;
};
using MixedModelPointer = std::unique_ptr<MixedModel, MixedModelDelete>;
[[nodiscard]] MixedModelPointer make_mixed_model();

template <class Code>
struct StripeRecord;

/// The bytes of one stripe of half a level. shift: bits of residuals that are told as they are, see LevelEncoder.
template <class Code>
[[nodiscard]] std::vector<std::byte> encode_mixed(MixedModel& model, const StripeRecord<Code>& stripe, std::size_t half,
                                                  int shift);

/// Whatever the bytes are, every candidate is told something.
template <class Code>
class MixedReader {
 public:
  MixedReader(MixedModel& model, std::span<const std::byte> bytes, std::size_t half, int shift);
  ~MixedReader();
  MixedReader(const MixedReader&) = delete;
  MixedReader& operator=(const MixedReader&) = delete;
  void take(CandidateRow<Code>& row);
  [[nodiscard]] bool is_intact() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace talus
