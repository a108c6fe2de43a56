#if defined(__x86_64__)
#define TALUS_VECTOR 32
#define TALUS_KERNEL_NAME avx2_eighths_kernel
#include "engine/dense/eighths_kernel.inc"
#endif
