#if defined(__x86_64__)
#define TALUS_VECTOR 32
#define TALUS_KERNEL_NAME avx2_triangle_kernel
#include "engine/quadtree/triangle_kernel.inc"
#endif
