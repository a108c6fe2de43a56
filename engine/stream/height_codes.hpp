#pragma once
// Heights of a stream as whole numbers, and back bit for bit: docs/format/rqt-v1.md, section 4.

#include <cstdint>
#include <optional>
#include <span>

#include "engine/stream/stream_header.hpp"
#include "talus/array.hpp"
#include "talus/description.hpp"

namespace talus {

struct HeightCoding {
  CodeKind kind = CodeKind::whole;
  bool is_wide = false;  ///< codes need 64 bits, otherwise 32 hold them
  HeightStep step;       ///< of whole codes and quanta
  double tolerance = 1;  ///< in codes

  /// Of all heights that a stream has to do with.
  /// fails  invalid_argument: a height that is not finite, or no multiple of the quantum
  [[nodiscard]] static HeightCoding of(const Description& d, Metres quantum, Metres tolerance,
                                       std::span<const std::span<const double>> heights);
  /// As a header says.
  [[nodiscard]] static HeightCoding of(const StreamHeader& header);
};

/// Nothing, if a height has no code.
template <class Code>
[[nodiscard]] std::optional<Array<Code>> codes_of(const HeightCoding& coding, std::span<const double> heights);

/// fails  corrupt: a height that is not finite
template <class Code>
[[nodiscard]] Array<double> heights_of(const HeightCoding& coding, std::span<const Code> codes);

}  // namespace talus
