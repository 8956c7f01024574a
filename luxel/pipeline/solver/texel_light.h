// What gather and the path tracer have in common.
#pragma once

#include <algorithm>

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

/// From what both call by the same names.
template <class Solved>
TexelLight texel_light(Solved&& solved) {
  TexelLight out;
  out.suspicious_texels = uint64_t(std::count(solved.enclosed.begin(), solved.enclosed.end(), 1));
  out.hidden = std::move(solved.enclosed);
  out.irradiance = std::move(solved.irradiance);
  out.rays = solved.rays;
  out.relative_error = solved.relative_error;
  return out;
}

}  // namespace luxel::pipeline
