#include "engine/error/kernel_choice.hpp"

#include "engine/machine/instruction_set.hpp"

namespace talus::detail {

extern const BlockKernel portable_block_kernel;
#if defined(__x86_64__)
extern const BlockKernel avx2_block_kernel, avx512_block_kernel;
#endif

const BlockKernel& block_kernel() {
  switch (instruction_set()) {
#if defined(__x86_64__)
    case InstructionSet::avx512: return avx512_block_kernel;
    case InstructionSet::avx2: return avx2_block_kernel;
#endif
    default: return portable_block_kernel;
  }
}

}  // namespace talus::detail
