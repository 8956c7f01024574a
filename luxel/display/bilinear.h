// Where a picture is looked up between its texels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/vec.h"
#include "luxel/image/image.h"

namespace luxel::display {

/// Four texels around a place of a picture, and their weights.
struct BilinearTexels {
  std::array<std::array<int, 2>, 4> texel;
  std::array<float, 4> weight;
};

/// Places beyond the edge are on it.
inline BilinearTexels bilinear_texels(int width, int height, Vec2 uv) {
  const float x = uv.x * float(width) - 0.5f, y = uv.y * float(height) - 0.5f;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  const float fx = x - float(x0), fy = y - float(y0);
  BilinearTexels out;
  for (size_t k = 0; k < 4; ++k) {
    const int i = int(k % 2), j = int(k / 2);
    out.texel[k] = {std::clamp(x0 + i, 0, width - 1), std::clamp(y0 + j, 0, height - 1)};
    out.weight[k] = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
  }
  return out;
}

inline Rgb bilinear_at(const image::Image& picture, Vec2 uv) {
  const BilinearTexels texels = bilinear_texels(picture.width, picture.height, uv);
  Rgb sum{};
  for (size_t k = 0; k < 4; ++k)
    sum += picture.rgb(texels.texel[k][0], texels.texel[k][1]) * texels.weight[k];
  return sum;
}

}  // namespace luxel::display
