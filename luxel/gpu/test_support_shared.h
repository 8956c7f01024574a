// A member of every kind, for a test of shared_language.h. C++ and GLSL.
#ifndef LUXEL_GPU_TEST_SUPPORT_SHARED_H
#define LUXEL_GPU_TEST_SUPPORT_SHARED_H
#include "luxel/gpu/shared_language.h"
SHARED_BEGIN

const uint kTestFields = 29;

IN_BUFFER(TestFloats, float);
BUFFER(TestNumbers, uint);
OUT_BUFFER(TestAnswers, float);
VECTORS(TestVectors);

struct TestPair {
  int first;
  float second;
};
IN_BUFFER(TestPairs, TestPair);

IN_BLOCK(TestBlock) {
  uint whole;
  vec3 three;
  REF(TestFloats) floats;
};

BLOCK(TestFields) {
  uint whole;
  REF(TestBlock) block;
  int negative;
  double fine;
  vec2 two;
  vec3 three;
  uvec2 seed;
  ARRAY(float, 3) some;
  TestPair pair;
  ARRAY(TestPair, 2) pairs;
  mat4 matrix;
};

PUSH(TestPush) {
  uint last;
  REF(TestFields) fields;
  REF(TestPairs) pairs;
  REF(TestVectors) vectors;
  REF(TestNumbers) numbers;
  REF(TestAnswers) answers;
};

SHARED_END
#endif
