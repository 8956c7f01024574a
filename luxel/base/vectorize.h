// Loops that the compiler turns into vector code.
#pragma once

#include <cstdint>

/// Compiles a function twice, for AVX2 and for any processor, and chooses when the program is
/// loaded; the second one also for AVX-512, where it pays. Without fused multiply-add, which the
/// build forbids, all give the same bits. The sanitizers would have to run before the choice can be
/// made, so they get one version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LUXEL_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#define LUXEL_WIDE_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define LUXEL_VECTOR_CLONES
#define LUXEL_WIDE_VECTOR_CLONES
#endif

namespace luxel {
inline namespace base {

/// Eight numbers that are added and multiplied at once (GCC's and Clang's vector types), for the
/// few loops that compilers do not see through. Inside LUXEL_VECTOR_CLONES they are one register,
/// elsewhere two. By reference only: how values are passed depends on the processor.
using Float8 = float __attribute__((vector_size(32)));
using Float16 = float __attribute__((vector_size(64)));
using Int8x8 = uint8_t __attribute__((vector_size(8)));
using Int16x8 = int16_t __attribute__((vector_size(16)));
using Int16x16 = int16_t __attribute__((vector_size(32)));
using Int32x8 = int32_t __attribute__((vector_size(32)));
using Int32x16 = int32_t __attribute__((vector_size(64)));

[[gnu::always_inline]] inline void load8(const float* from, Float8& to) {
  __builtin_memcpy(&to, from, sizeof to);
}
// Widened step by step: GCC 12 takes numbers one by one otherwise.
[[gnu::always_inline]] inline void load8(const uint8_t* from, Float8& to) {
  Int8x8 v;
  __builtin_memcpy(&v, from, sizeof v);
  to = __builtin_convertvector(
      __builtin_convertvector(__builtin_convertvector(v, Int16x8), Int32x8), Float8);
}
[[gnu::always_inline]] inline void load8(const int16_t* from, Float8& to) {
  Int16x8 v;
  __builtin_memcpy(&v, from, sizeof v);
  to = __builtin_convertvector(__builtin_convertvector(v, Int32x8), Float8);
}
// Sixteen, likewise.
[[gnu::always_inline]] inline void load16(const float* from, Float16& to) {
  __builtin_memcpy(&to, from, sizeof to);
}
[[gnu::always_inline]] inline void load16(const int16_t* from, Float16& to) {
  Int16x16 v;
  __builtin_memcpy(&v, from, sizeof v);
  to = __builtin_convertvector(__builtin_convertvector(v, Int32x16), Float16);
}
[[gnu::always_inline]] inline void store8(const Float8& from, float* to) {
  __builtin_memcpy(to, &from, sizeof from);
}

}  // namespace base
}  // namespace luxel
