#pragma once
// Loops that gain from wider vectors are compiled several times and the widest the processor has is taken, by
// TALUS_CLONES in front of the function. Only whole-number and exact arithmetic: all give the same bits.

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TALUS_CLONES [[gnu::target_clones("default", "avx2", "avx512f")]]
#define TALUS_BIT_CLONES [[gnu::target_clones("default", "bmi2")]]
#else
#define TALUS_CLONES
#define TALUS_BIT_CLONES
#endif
