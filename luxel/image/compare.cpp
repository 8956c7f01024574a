#include "luxel/image/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::image {
namespace {

Status check_comparable(const Image& image, std::string_view name) {
  for (size_t i = 0; i < image.data.size(); ++i) {
    if (std::isfinite(image.data[i])) continue;
    const size_t pixel = i / size_t(image.channels);
    return fail(ErrorCode::bad_input,
                "{}: pixel ({}, {}) is {}; only finite pictures can be compared", name,
                pixel % size_t(image.width), pixel / size_t(image.width), image.data[i]);
  }
  return {};
}

/// Contribution of a pixel's channel to the sums, and the sums themselves.
struct Sums {
  double b = 0, d = 0, abs_d = 0, d2 = 0, relative2 = 0;
  double max_abs = -1, max_b = -std::numeric_limits<double>::infinity();
  int max_x = 0, max_y = 0;
  uint64_t texels = 0;

  void add(const Sums& s) {
    b += s.b, d += s.d, abs_d += s.abs_d, d2 += s.d2, relative2 += s.relative2;
    texels += s.texels;
    max_b = std::max(max_b, s.max_b);
    if (s.max_abs > max_abs) max_abs = s.max_abs, max_x = s.max_x, max_y = s.max_y;
  }
};

/// (d / (|b| + floor))^2. Where nothing differs nothing is divided: the reference may be black.
double relative_square(double d, double b, double floor) {
  const double relative = d == 0 ? 0 : d / (std::abs(b) + floor);
  return relative * relative;
}

Sums sums_of_row(const Image& a, const Image& b, const Mask& covered, int y, double floor) {
  Sums s;
  for (int x = 0; x < a.width; ++x) {
    if (!covered[size_t(y) * size_t(a.width) + size_t(x)]) continue;
    ++s.texels;
    const float *pa = a.at(x, y), *pb = b.at(x, y);
    for (int c = 0; c < 3; ++c) {
      const double vb = pb[c], d = double(pa[c]) - vb;
      s.b += vb, s.d += d, s.abs_d += std::abs(d), s.d2 += d * d;
      s.max_b = std::max(s.max_b, vb);
      if (std::abs(d) > s.max_abs) s.max_abs = std::abs(d), s.max_x = x, s.max_y = y;
      s.relative2 += relative_square(d, vb, floor);
    }
  }
  return s;
}

Sums sums_of(const Image& a, const Image& b, const Mask& covered, double floor,
             const Progress* progress) {
  std::vector<Sums> rows(size_t(a.height));
  parallel_for(rows.size(), 16, [&](size_t begin, size_t end) {
    if (progress && progress->cancelled()) return;
    for (size_t y = begin; y < end; ++y) rows[y] = sums_of_row(a, b, covered, int(y), floor);
  });
  Sums total;
  for (const Sums& row : rows) total.add(row);
  return total;
}

double over(double value, double mean) { return value == 0 ? 0.0 : value / std::abs(mean); }

}  // namespace

Result<Mask> covered_pixels(const Image& a, std::string_view name_a, const Image& b,
                            std::string_view name_b) {
  if (a.width != b.width || a.height != b.height)
    return fail(ErrorCode::bad_input,
                "{} has {} x {} pixels and {} has {} x {}; only pictures of one size can be "
                "compared",
                name_a, a.width, a.height, name_b, b.width, b.height);
  if (a.channels != b.channels || a.channels < 3)
    return fail(ErrorCode::bad_input,
                "{} has {} channels and {} has {}; both need R, G and B, and both or none A",
                name_a, a.channels, name_b, b.channels);
  LUXEL_TRY_STATUS(check_comparable(a, name_a));
  LUXEL_TRY_STATUS(check_comparable(b, name_b));
  const size_t pixels = size_t(a.width) * size_t(a.height);
  Mask covered(pixels, 1);
  if (a.channels == 4)
    for (size_t i = 0; i < pixels; ++i)
      covered[i] = a.data[4 * i + 3] >= 1 && b.data[4 * i + 3] >= 1;
  if (std::find(covered.begin(), covered.end(), 1) == covered.end())
    return fail(ErrorCode::bad_input,
                "{} and {} have no pixel in common that both cover (alpha at least 1), so there is "
                "nothing to compare",
                name_a, name_b);
  return covered;
}

Difference difference(const Image& a, const Image& b, const Mask& covered,
                      const Progress* progress) {
  LUXEL_CHECK(a.width == b.width && a.height == b.height && a.channels >= 3 && b.channels >= 3);
  LUXEL_CHECK(covered.size() == size_t(a.width) * size_t(a.height));
  Difference out;
  // The mean of b is needed before relative errors can be summed: two passes.
  const Sums first = sums_of(a, b, covered, 1, progress);
  if (progress && progress->cancelled()) return out;
  LUXEL_CHECK(first.texels > 0);
  const double n = 3 * double(first.texels);
  out.texels = first.texels;
  out.mean = first.b / n;
  const Sums s = sums_of(a, b, covered, 0.01 * std::abs(out.mean), progress);
  out.rmse = std::sqrt(s.d2 / n);
  out.rmse_over_mean = over(out.rmse, out.mean);
  out.relative_rmse = std::sqrt(s.relative2 / n);
  out.mean_abs = s.abs_d / n;
  out.max_abs = s.max_abs;
  out.max_at = {s.max_x, s.max_y};
  out.bias = s.d / n;
  out.bias_over_mean = over(out.bias, out.mean);
  out.peak = s.max_b;
  out.psnr_db = out.rmse > 0 ? 20 * std::log10(std::max(out.peak, 0.0) / out.rmse)
                             : std::numeric_limits<double>::infinity();
  return out;
}

Result<Difference> compare(const Image& a, std::string_view name_a, const Image& b,
                           std::string_view name_b) {
  LUXEL_TRY(const Mask covered, covered_pixels(a, name_a, b, name_b));
  return difference(a, b, covered);
}

Image relative_error_map(const Image& a, const Image& b, const Mask& covered, double mean) {
  Image map(a.width, a.height, 1);
  const double floor = 0.01 * std::abs(mean);
  parallel_for(size_t(a.height), 16, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < a.width; ++x) {
        if (!covered[map.index(x, y)]) continue;
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
          const double vb = b.at(x, y)[c], d = double(a.at(x, y)[c]) - vb;
          sum += relative_square(d, vb, floor);
        }
        *map.at(x, y) = float(std::min(std::sqrt(sum / 3), 1e30));
      }
  });
  return map;
}

double mean_over(const Image& map, const Mask& covered) {
  LUXEL_CHECK(map.channels == 1 && map.data.size() == covered.size());
  double total = 0;
  uint64_t count = 0;
  for (int y = 0; y < map.height; ++y) {
    double row = 0;
    for (int x = 0; x < map.width; ++x)
      if (covered[map.index(x, y)]) row += double(*map.at(x, y)), ++count;
    total += row;
  }
  return count ? total / double(count) : 0;
}

double quantile_over(const Image& map, const Mask& covered, double q) {
  LUXEL_CHECK(map.channels == 1 && map.data.size() == covered.size());
  std::vector<float> values;
  for (size_t i = 0; i < covered.size(); ++i)
    if (covered[i]) values.push_back(map.data[i]);
  if (values.empty()) return 0;
  const size_t rank = std::min(values.size() - 1, size_t(q * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
  return double(values[rank]);
}

}  // namespace luxel::image
