#define TALUS_VECTOR 16
#define TALUS_KERNEL_NAME portable_triangle_kernel
#include "engine/quadtree/triangle_kernel.inc"
