#pragma once

/// A function that is compiled for several instruction sets, the levels of the x86-64 ABI (AVX2 with FMA, AVX-512). The
/// program chooses one when it starts, by the features of the processor. Sanitizers and clang take the plain version.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(PATCHLIGHT_ONE_INSTRUCTION_SET)
#define PATCHLIGHT_TARGET_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
/// The same for a function that is written several times, as it differs by the instruction set; the other two only
/// where PATCHLIGHT_HAS_TARGETS.
#define PATCHLIGHT_HAS_TARGETS
#define PATCHLIGHT_TARGET_PLAIN __attribute__((target("default")))
#define PATCHLIGHT_TARGET_AVX2 __attribute__((target("arch=x86-64-v3")))
#define PATCHLIGHT_TARGET_AVX512 __attribute__((target("arch=x86-64-v4")))
#else
#define PATCHLIGHT_TARGET_CLONES
#define PATCHLIGHT_TARGET_PLAIN
#endif

/// Before a loop of few steps: it is unrolled also by builds that leave such loops alone.
#if defined(__GNUC__) && !defined(__clang__)
#define PATCHLIGHT_UNROLL _Pragma("GCC unroll 8")
#else
#define PATCHLIGHT_UNROLL
#endif

/// For functions that such a function calls: they must be inlined into it.
#define PATCHLIGHT_INLINE [[gnu::always_inline]] inline
