#pragma once
// Converts heights of a stream to whole numbers, and back bit for bit. docs/format/rqt-v1.md, section 4.

#include <cstdint>
#include <optional>
#include <span>

#include "engine/stream/stream_header.hpp"
#include "talus/array.hpp"
#include "talus/description.hpp"

namespace talus {

struct HeightCoding {
  CodeKind kind = CodeKind::whole;
  bool is_wide = false;  ///< codes have 64 bits, otherwise 32
  HeightStep step;       ///< step of whole codes and quanta
  double tolerance = 1;  ///< tolerance of the answer, in codes

  /// The smallest coding for all heights of a stream, and those of its base.
  /// fails  invalid_argument: a height that is infinite or NaN, or lies between multiples of the quantum
  [[nodiscard]] static HeightCoding of(const Description& d, Metres quantum, Metres tolerance,
                                       std::span<const std::span<const double>> heights);
  /// The coding that a header names.
  [[nodiscard]] static HeightCoding of(const StreamHeader& header);
};

/// The codes of heights; empty if a height has no code.
template <class Code>
[[nodiscard]] std::optional<Array<Code>> codes_of(const HeightCoding& coding, std::span<const double> heights);

/// fails  corrupt: a height is infinite or NaN
template <class Code>
[[nodiscard]] Array<double> heights_of(const HeightCoding& coding, std::span<const Code> codes);

}  // namespace talus
