#define TALUS_VECTOR 16
#define TALUS_KERNEL_NAME portable_eighths_kernel
#include "engine/dense/eighths_kernel.inc"
