#pragma once
// The kernels of pages, by set of instructions.

#include "engine/dense/dense_kernel.hpp"
#include "engine/dense/eighths_kernel.hpp"
#include "engine/machine/instruction_set.hpp"

namespace talus::detail {

/// All give the same numbers. Numbers of 64 bits have one only, without vectors.
template <class T>
[[nodiscard]] DenseFunctions<T> dense_functions(InstructionSet set);
/// All give the same errors and bits.
[[nodiscard]] const EighthsKernel& eighths_kernel(InstructionSet set);

}  // namespace talus::detail
