// Sobol points under Owen's scrambling, and numbers from bits. C++ and GLSL.
#ifndef LUXEL_BASE_BOTH_SOBOL_H
#define LUXEL_BASE_BOTH_SOBOL_H
#include "luxel/base/both_language.h"
BOTH_BEGIN

// [0, 1) from the top 24 bits: exact in a float, never 1.
BOTH float unit_float(uint bits) { return float(bits >> 8) * 5.9604644775390625e-8f; }

BOTH uint reverse_bits(uint x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

// The three low bits in reverse order; x < 8.
BOTH uint reverse_3_bits(uint x) { return (x & 1u) << 2 | (x & 2u) | (x & 4u) >> 2; }

// A bijection in which each bit depends only on lower bits: on bit-reversed input this is nested
// (Owen) scrambling. Constants from Vegdahl's search, as published. [Vegdahl21]
BOTH uint scramble_upwards(uint x, uint seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// The second Sobol dimension, bit-reversed: row k of its generator is row k-1 of Pascal's triangle
// modulo 2, which the loop below unrolls as prefix XORs of the index. [Ahmed24, eq. 12]
BOTH uint sobol_second_reversed(uint index) {
  index ^= (index & 0xaaaaaaaau) >> 1;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xffff0000u) >> 16;
  return index;
}

// The point of a block of 64, numbered from 64 * block on, that lies in column x and row y of 8 x 8
// parts of the square: there is one. The low three bits of an index say in which column it lies;
// bits 3 to 5 reach the three leading bits of the second coordinate by columns 3 to 5 of Pascal's
// triangle modulo 2, which are 111, 001 and 011: solved for these bits.
BOTH uint sample_of_eighths(uint block, uint x, uint y) {
  uint index = block << 6 | reverse_3_bits(x);
  uint rest = (sobol_second_reversed(index) & 7u) ^ reverse_3_bits(y);
  return index | (rest & 4u) << 1 | ((rest ^ rest >> 1) & 1u) << 4 |
         ((rest >> 1 ^ rest >> 2) & 1u) << 5;
}

BOTH_END
#endif
