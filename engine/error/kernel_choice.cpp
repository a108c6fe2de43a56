#include "engine/error/kernel_choice.hpp"

#include "engine/machine/instruction_set.hpp"

namespace talus::detail {

extern const BlockKernel portable_block_kernel, avx2_block_kernel, avx512_block_kernel;

const BlockKernel& block_kernel() { return kernel_for(instruction_set(), TALUS_KERNELS(block_kernel)); }

}  // namespace talus::detail
