#define TALUS_VECTOR 16
#define TALUS_KERNEL_NAME portable_dense_kernel
#include "engine/page/dense_kernel.inc"
