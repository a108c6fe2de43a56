#pragma once
// The kernels of dense pages, by set of instructions.

#include "engine/machine/instruction_set.hpp"
#include "engine/page/dense_kernel.hpp"

namespace talus::detail {

/// All kernels give the same numbers. Numbers of 64 bits have one only, without vectors.
template <class T>
[[nodiscard]] DenseFunctions<T> dense_functions(InstructionSet set);

}  // namespace talus::detail
