#include "engine/page/dense_kernel_choice.hpp"

#include "engine/page/dense_plain.hpp"

namespace talus::detail {

extern const DenseKernel portable_dense_kernel;
#if defined(__x86_64__)
extern const DenseKernel avx2_dense_kernel, avx512_dense_kernel;
#endif

namespace {

const DenseKernel& kernel_of(InstructionSet set) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::avx512: return avx512_dense_kernel;
    case InstructionSet::avx2: return avx2_dense_kernel;
#endif
    default: return portable_dense_kernel;
  }
}

}  // namespace

template <>
DenseFunctions<std::uint16_t> dense_functions(InstructionSet set) {
  return kernel_of(set).narrow;
}
template <>
DenseFunctions<std::uint32_t> dense_functions(InstructionSet set) {
  return kernel_of(set).wide;
}
template <>
DenseFunctions<std::uint64_t> dense_functions(InstructionSet) {
  return kPlainDense<std::uint64_t>;
}

}  // namespace talus::detail
