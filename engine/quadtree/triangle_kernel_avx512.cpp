#if defined(__x86_64__)
#define TALUS_VECTOR 64
#define TALUS_KERNEL_NAME avx512_triangle_kernel
#include "engine/quadtree/triangle_kernel.inc"
#endif
