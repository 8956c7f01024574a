#include "luxel/export/small_picture.h"

#include <algorithm>

#include "luxel/base/parallel.h"

namespace luxel::export_ {
namespace {

/// Pixels of a row of `from` that a pixel of a row of `to` covers, and how much of each.
struct Cover {
  int first = 0;
  std::vector<double> weight;  ///< their sum is 1
};
Cover cover_of(int i, int from, int to) {
  const double begin = double(i) * from / to, end = double(i + 1) * from / to;
  Cover out{int(begin), {}};
  for (int k = out.first; k < from && k < end; ++k)
    out.weight.push_back((std::min(end, k + 1.0) - std::max(begin, double(k))) / (end - begin));
  return out;
}

}  // namespace

image::Image small_picture(const scene::Environment& map, int width) {
  image::Image out(std::min(width, map.width), std::min(width / 2, map.height), 4);
  parallel_for(size_t(out.height), 8, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y) {
      const Cover rows = cover_of(y, map.height, out.height);
      for (int x = 0; x < out.width; ++x) {
        const Cover columns = cover_of(x, map.width, out.width);
        double sum[3] = {};
        for (size_t j = 0; j < rows.weight.size(); ++j)
          for (size_t i = 0; i < columns.weight.size(); ++i) {
            const Rgb c = map.radiance[(size_t(rows.first) + j) * size_t(map.width) +
                                       size_t(columns.first) + i];
            const double w = rows.weight[j] * columns.weight[i];
            sum[0] += w * double(c.x), sum[1] += w * double(c.y), sum[2] += w * double(c.z);
          }
        out.set_rgb(x, y, {float(sum[0]), float(sum[1]), float(sum[2])});
        out.at(x, y)[3] = 1;
      }
    }
  });
  return out;
}

}  // namespace luxel::export_
