// Parts of a texel's light that several solvers and the steps after them share.
#pragma once

#include <algorithm>

#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {

/// Mean luminance of E over texels that are not hidden [W/m^2]; 0 without any.
inline double mean_light(const TexelLight& light) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < light.irradiance.size(); ++i)
    if (!light.hidden[i]) sum += double(luminance(light.irradiance[i])), count += 1;
  return count > 0 ? sum / count : 0;
}

/// The light of gather or of the path tracer, from what both call by one name.
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
