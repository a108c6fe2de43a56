#pragma once
// Macros for gcc: compile a loop for several processors, and use the instruction that counts bits.

// A function with TALUS_CLONES is compiled several times; at run time the widest version that the
// processor supports is used. Only for whole-number and exact arithmetic, so that all versions give the same bits.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TALUS_CLONES [[gnu::target_clones("default", "avx2", "avx512f")]]
#else
#define TALUS_CLONES
#endif

// A function with TALUS_POPCNT uses the instruction that counts bits (half of the work with ranks). Call it only if
// has_popcnt(). Mark the functions that it calls TALUS_INLINE, otherwise nothing is gained.
#if defined(__GNUC__) && defined(__x86_64__)
#define TALUS_INLINE [[gnu::always_inline]] inline
#define TALUS_POPCNT [[gnu::target("popcnt")]]
#else
#define TALUS_INLINE inline
#define TALUS_POPCNT
#endif

namespace talus {

inline bool has_popcnt() {
#if defined(__GNUC__) && defined(__x86_64__)
  return __builtin_cpu_supports("popcnt") != 0;
#else
  return false;
#endif
}

}  // namespace talus
