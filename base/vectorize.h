// Loops that the compiler turns into vector code.
#pragma once

/// Compiles a function twice, for AVX2 and for any processor, and chooses when the program is
/// loaded. Without fused multiply-add, which the build forbids, both give the same bits. The
/// sanitizers run before the choice can be made, so they get one version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define LUXEL_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define LUXEL_VECTOR_CLONES
#endif
