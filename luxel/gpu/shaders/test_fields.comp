// Reads each member of ../test_support_shared.h, in order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/gpu/test_support_shared.h"
layout(local_size_x = 1) in;

void answer(float value) { answers.at[numbers.at[0]++] = value; }
void answer(vec3 value) {
  for (int k = 0; k < 3; ++k) answer(value[k]);
}
void answer(TestPair pair) {
  answer(float(pair.first));
  answer(pair.second);
}

void main() {
  answer(float(fields.whole));
  answer(float(fields.block.whole));
  answer(fields.block.three);
  answer(fields.block.floats.at[1]);
  answer(float(fields.negative));
  answer(float(fields.fine));
  answer(vec3(fields.two, fields.three.x));
  answer(vec3(fields.three.yz, float(fields.seed.x)));
  answer(float(fields.seed.y));
  for (int k = 0; k < 3; ++k) answer(fields.some[k]);
  answer(fields.pair);
  for (int k = 0; k < 2; ++k) answer(fields.pairs[k]);
  answer(fields.matrix[2][1]);
  answer(pairs.at[1]);
  answer(vectors.at[1].w);
  answer(float(last));
}
