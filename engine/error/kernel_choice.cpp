#include "engine/error/kernel_choice.hpp"

#include <cstdlib>
#include <string>
#include <vector>

#include "engine/machine/fail.hpp"

namespace talus::detail {

extern const BlockKernel portable_block_kernel;
#if defined(__x86_64__)
extern const BlockKernel avx2_block_kernel, avx512_block_kernel;
#endif

namespace {

/// The kernels that this processor can run, the fastest last.
std::vector<const BlockKernel*> kernels_here() {
  std::vector<const BlockKernel*> kernels{&portable_block_kernel};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) kernels.push_back(&avx2_block_kernel);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    kernels.push_back(&avx512_block_kernel);
  }
#endif
  return kernels;
}

}  // namespace

const BlockKernel& block_kernel() {
  static const std::vector<const BlockKernel*> here = kernels_here();
  const char* wanted = std::getenv("TALUS_KERNEL");
  if (wanted == nullptr || *wanted == '\0') return *here.back();
  std::string names;
  for (const BlockKernel* kernel : here) {
    if (kernel->name == std::string(wanted)) return *kernel;
    names += (names.empty() ? "" : ", ") + std::string(kernel->name);
  }
  refuse("TALUS_KERNEL is {}: choose one that this machine has: {}", wanted, names);
}

}  // namespace talus::detail
