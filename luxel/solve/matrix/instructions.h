// The vector instructions that the hand-written kernels of this room may use. All kernels of one
// function add the same numbers in the same order, so that each gives the same bits; what one fuses
// (multiply and add) all fuse.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define LUXEL_X86_VECTORS 1
#include <cpuid.h>
#else
#define LUXEL_X86_VECTORS 0
#endif

namespace luxel::matrix {

enum class Instructions {
  any,
  avx2,    ///< with F16C and FMA
  avx512,  ///< F and VL; with BMI2, whose pext is quick wherever they are
};

/// The best that this processor has.
inline Instructions instructions() {
#if LUXEL_X86_VECTORS
  // Clang 14 does not know "f16c" by name: bit 29 of leaf 1. [Intel SDM, vol. 2A, CPUID]
  unsigned a = 0, b = 0, c = 0, d = 0;
  const bool f16c = __get_cpuid(1, &a, &b, &c, &d) != 0 && (c >> 29 & 1) != 0;
  if (!__builtin_cpu_supports("avx2") || !f16c || !__builtin_cpu_supports("fma"))
    return Instructions::any;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                    __builtin_cpu_supports("bmi2");
  return wide ? Instructions::avx512 : Instructions::avx2;
#else
  return Instructions::any;
#endif
}

}  // namespace luxel::matrix
