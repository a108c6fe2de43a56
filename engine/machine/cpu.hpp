#pragma once
// What gcc is told about the processor: loops compiled several times, and the instruction that counts bits.

// TALUS_CLONES and TALUS_BIT_CLONES in front of a function compile it several times; the widest version that the
// processor has is taken. Use them only for whole-number and exact arithmetic, so that all versions give the same bits.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TALUS_CLONES [[gnu::target_clones("default", "avx2", "avx512f")]]
#define TALUS_BIT_CLONES [[gnu::target_clones("default", "bmi2")]]
#else
#define TALUS_CLONES
#define TALUS_BIT_CLONES
#endif

// Counting bits is half of the work with ranks. A function marked TALUS_POPCNT is compiled with the processor's
// instruction for it; call it only if has_popcnt() says so. Mark what it calls TALUS_INLINE, or nothing is gained.
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
