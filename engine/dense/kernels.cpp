#include "engine/dense/kernels.hpp"

#include "engine/dense/dense_plain.hpp"

namespace talus::detail {

extern const DenseKernel portable_dense_kernel;
extern const EighthsKernel portable_eighths_kernel;
#if defined(__x86_64__)
extern const DenseKernel avx2_dense_kernel, avx512_dense_kernel;
extern const EighthsKernel avx2_eighths_kernel, avx512_eighths_kernel;
#endif

namespace {

const DenseKernel& dense_kernel(InstructionSet set) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::avx512: return avx512_dense_kernel;
    case InstructionSet::avx2: return avx2_dense_kernel;
#endif
    default: return portable_dense_kernel;
  }
}

}  // namespace

const EighthsKernel& eighths_kernel(InstructionSet set) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::avx512: return avx512_eighths_kernel;
    case InstructionSet::avx2: return avx2_eighths_kernel;
#endif
    default: return portable_eighths_kernel;
  }
}

template <>
DenseFunctions<std::uint16_t> dense_functions(InstructionSet set) {
  return dense_kernel(set).narrow;
}
template <>
DenseFunctions<std::uint32_t> dense_functions(InstructionSet set) {
  return dense_kernel(set).wide;
}
template <>
DenseFunctions<std::uint64_t> dense_functions(InstructionSet) {
  return kPlainDense<std::uint64_t>;
}

}  // namespace talus::detail
