#include "engine/dense/kernels.hpp"

#include "engine/dense/dense_plain.hpp"

namespace talus::detail {

extern const DenseKernel portable_dense_kernel, avx2_dense_kernel, avx512_dense_kernel;
extern const EighthsKernel portable_eighths_kernel, avx2_eighths_kernel, avx512_eighths_kernel;

const EighthsKernel& eighths_kernel(InstructionSet set) { return kernel_for(set, TALUS_KERNELS(eighths_kernel)); }

template <>
DenseFunctions<std::uint16_t> dense_functions(InstructionSet set) {
  return kernel_for(set, TALUS_KERNELS(dense_kernel)).narrow;
}
template <>
DenseFunctions<std::uint32_t> dense_functions(InstructionSet set) {
  return kernel_for(set, TALUS_KERNELS(dense_kernel)).wide;
}
template <>
DenseFunctions<std::uint64_t> dense_functions(InstructionSet) {
  return kPlainDense<std::uint64_t>;
}

}  // namespace talus::detail
