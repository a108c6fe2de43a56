#pragma once
// The kernel of errors for this processor.

#include "engine/error/block_kernel.hpp"

namespace talus::detail {

/// The kernel for instruction_set() (engine/machine/instruction_set.hpp). All give the same bits.
/// fails  invalid_argument: as instruction_set()
[[nodiscard]] const BlockKernel& block_kernel();

}  // namespace talus::detail
