#define TALUS_VECTOR 16
#define TALUS_KERNEL_NAME portable_block_kernel
#include "engine/error/block_kernel.inc"
