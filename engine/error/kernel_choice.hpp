#pragma once
// Which of the kernels runs here.

#include "engine/error/block_kernel.hpp"

namespace talus::detail {

/// The fastest that this processor has; the one that the environment variable TALUS_KERNEL names, if it is set:
/// portable, avx2 or avx512. All give the same bits.
/// fails  invalid_argument: another word, or one that this processor (or this build) lacks
[[nodiscard]] const BlockKernel& block_kernel();

}  // namespace talus::detail
