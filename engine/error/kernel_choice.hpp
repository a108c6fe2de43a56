#pragma once
// Chooses the kernel of errors for this processor. Other hot loops leave the choice to the compiler: TALUS_CLONES in
// engine/machine/cpu.hpp.

#include "engine/error/block_kernel.hpp"

namespace talus::detail {

/// The fastest kernel of this processor, or the one that the environment variable TALUS_KERNEL names: portable, avx2 or
/// avx512. All give the same bits.
/// fails  invalid_argument: TALUS_KERNEL names none, or one that this processor or build lacks
[[nodiscard]] const BlockKernel& block_kernel();

}  // namespace talus::detail
