// An image in memory: rows of interleaved floats, row 0 on top.
#pragma once

#include <cstddef>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::image {

/// A picture of floats. Linear light unless a function says otherwise; row 0 is on top.
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> data;  ///< width * height * channels values

  Image() = default;
  /// w * h pixels of c channels, all 0.
  Image(int w, int h, int c)
      : width(w), height(h), channels(c), data(size_t(w) * size_t(h) * size_t(c)) {}

  /// Where the channels of a pixel begin in `data`.
  size_t index(int x, int y) const {
    return (size_t(y) * size_t(width) + size_t(x)) * size_t(channels);
  }
  /// The channels of a pixel.
  float* at(int x, int y) { return data.data() + index(x, y); }
  /// The channels of a pixel.
  const float* at(int x, int y) const { return data.data() + index(x, y); }
  /// The first three channels of a pixel; there must be as many.
  Rgb rgb(int x, int y) const {
    const float* p = at(x, y);
    return {p[0], p[1], p[2]};
  }
  /// Sets the first three channels of a pixel.
  void set_rgb(int x, int y, Rgb c) {
    float* p = at(x, y);
    p[0] = c.x, p[1] = c.y, p[2] = c.z;
  }
};

}  // namespace luxel::image
