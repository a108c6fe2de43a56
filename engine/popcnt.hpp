#pragma once
// Counting bits is half of the work with ranks, and one instruction on processors that have it. Functions marked
// TALUS_POPCNT are compiled with that instruction and may be called if has_popcnt() says so; what they call must be
// TALUS_INLINE to profit.

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
