// An image in memory: rows of interleaved floats, row 0 on top.
#pragma once

#include <cstddef>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::image {

struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> data;  ///< width * height * channels values

  Image() = default;
  Image(int w, int h, int c)
      : width(w), height(h), channels(c), data(size_t(w) * size_t(h) * size_t(c)) {}

  size_t index(int x, int y) const {
    return (size_t(y) * size_t(width) + size_t(x)) * size_t(channels);
  }
  float* at(int x, int y) { return data.data() + index(x, y); }
  const float* at(int x, int y) const { return data.data() + index(x, y); }
  Rgb rgb(int x, int y) const {
    const float* p = at(x, y);
    return {p[0], p[1], p[2]};
  }
  void set_rgb(int x, int y, Rgb c) {
    float* p = at(x, y);
    p[0] = c.x, p[1] = c.y, p[2] = c.z;
  }
};

}  // namespace luxel::image
