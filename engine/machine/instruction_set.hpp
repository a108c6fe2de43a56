#pragma once
// Which instructions this processor has, for loops that are compiled several times: kernels. Other hot loops leave the
// choice to the compiler: TALUS_CLONES in engine/machine/cpu.hpp.

#include <cstddef>
#include <span>
#include <string_view>

namespace talus {

/// What a kernel may use beyond what every processor of its kind has. Each has all that those before it have.
enum class InstructionSet {
  portable,  ///< nothing
  avx2,      ///< AVX2, BMI1, BMI2, POPCNT
  avx512     ///< AVX-512 F, BW, VL, DQ, VBMI, VBMI2, BITALG, VPOPCNTDQ
};

[[nodiscard]] std::string_view to_string(InstructionSet set);

/// The sets that this processor and this build have, the widest last.
[[nodiscard]] std::span<const InstructionSet> instruction_sets_here();

/// The widest set of this processor, or the one that the environment variable TALUS_KERNEL names: portable, avx2 or
/// avx512.
/// fails  invalid_argument: TALUS_KERNEL names none, or one that this processor or build lacks
[[nodiscard]] InstructionSet instruction_set();

/// The kernels of a name, by set: portable_NAME, avx2_NAME, avx512_NAME, each defined in a source of its own.
#if defined(__x86_64__)
#define TALUS_KERNELS(NAME) \
  { &portable_##NAME, &avx2_##NAME, &avx512_##NAME }
#else
#define TALUS_KERNELS(NAME) \
  { &portable_##NAME }
#endif
/// The one for a set of instruction_sets_here().
template <class Kernel, std::size_t Sets>
[[nodiscard]] const Kernel& kernel_for(InstructionSet set, const Kernel* const (&kernels)[Sets]) {
  return *kernels[static_cast<std::size_t>(set)];
}

/// Whether pext and pdep of BMI2 take hundreds of cycles: AMD before Zen 3.
[[nodiscard]] bool has_slow_pext();

}  // namespace talus
