#if defined(__x86_64__)
#define TALUS_VECTOR 32
#define TALUS_KERNEL_NAME avx2_block_kernel
#include "engine/error/block_kernel.inc"
#endif
