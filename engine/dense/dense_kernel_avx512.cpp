#if defined(__x86_64__)
#define TALUS_VECTOR 64
#define TALUS_KERNEL_NAME avx512_dense_kernel
#include "engine/dense/dense_kernel.inc"
#endif
