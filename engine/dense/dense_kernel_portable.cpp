#define TALUS_VECTOR 16
#define TALUS_KERNEL_NAME portable_dense_kernel
#include "engine/dense/dense_kernel.inc"
