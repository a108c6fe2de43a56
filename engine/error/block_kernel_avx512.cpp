#if defined(__x86_64__)
#define TALUS_VECTOR 64
#define TALUS_KERNEL_NAME avx512_block_kernel
#include "engine/error/block_kernel.inc"
#endif
