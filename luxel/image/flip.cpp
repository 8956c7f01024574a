#include "luxel/image/flip.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vec.h"
#include "luxel/image/flip_filters.h"

namespace luxel::image {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// Linear sRGB to XYZ, each row divided by the white's value (D65 at x = 0.31271, y = 0.32902, as
/// in [Andersson20]), so that white is (1, 1, 1).
constexpr Matrix kXyzFromRgb{
    {{0.412386563 / 0.950428545, 0.357591491 / 0.950428545, 0.180450491 / 0.950428545},
     {0.212636822, 0.715182982, 0.072180196},
     {0.019330620 / 1.088900371, 0.119197164 / 1.088900371, 0.950372587 / 1.088900371}}};

constexpr Matrix inverse(const Matrix& m) {
  const auto minor = [&](size_t i, size_t j) {
    const size_t r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return m[r][c] * m[s][d] - m[r][d] * m[s][c];
  };
  const double det = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  Matrix out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) out[i][j] = minor(j, i) / det;
  return out;
}
constexpr Matrix kRgbFromXyz = inverse(kXyzFromRgb);

Vec3 multiply(const Matrix& m, Vec3 v) {
  const auto row = [&](size_t i) {
    return float(m[i][0]) * v.x + float(m[i][1]) * v.y + float(m[i][2]) * v.z;
  };
  return {row(0), row(1), row(2)};
}

Rgb clamp01(Rgb c) { return min(max(c, Rgb{}), Rgb{1, 1, 1}); }

/// The opponent space of the spatial filters. YCxCz is (116 Y - 16, 500 (X - Y), 200 (Y - Z)); the
/// filters have sum 1, so scales and offset would be undone behind them and are left out.
Vec3 opponent_from_rgb(Rgb c) {
  const Vec3 xyz = multiply(kXyzFromRgb, c);
  return {xyz.y, xyz.x - xyz.y, xyz.y - xyz.z};
}
Rgb rgb_from_opponent(Vec3 o) { return multiply(kRgbFromXyz, {o.x + o.y, o.x, o.x - o.z}); }

/// For x > 0, to a few roundings and several times as fast as std::cbrt. A third of the float's
/// bits is within 4 % of the root; each step of Halley's method has the cube of the error before.
float cube_root(float x) {
  float y = std::bit_cast<float>(std::bit_cast<uint32_t>(x) / 3 + 0x2a510000u);
  for (int i = 0; i < 2; ++i) {
    const float cube = y * y * y;
    y *= (cube + 2 * x) / (2 * cube + x);
  }
  return y;
}

/// CIE L*a*b*, with a and b scaled by L / 100: colours look more colourful when bright (Hunt).
Vec3 hunt_lab_from_rgb(Rgb c) {
  constexpr float kDelta = 6.0f / 29;
  const auto f = [](float t) {
    return t > kDelta * kDelta * kDelta ? cube_root(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
  };
  const Vec3 xyz = multiply(kXyzFromRgb, c);
  const float fx = f(xyz.x), fy = f(xyz.y), fz = f(xyz.z);
  const float lightness = 116 * fy - 16;
  return {lightness, 0.01f * lightness * 500 * (fx - fy), 0.01f * lightness * 200 * (fy - fz)};
}

/// The HyAB distance: city block between lightness and the Euclidean rest.
float hyab(Vec3 a, Vec3 b) {
  const Vec3 d = a - b;
  return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

constexpr float kColorExponent =
    0.7f;  // q_c of the paper; its feature exponent q_f = 1/2 is a root

/// The largest distance in the space, between green and blue, after the exponent.
float largest_color_difference() {
  return std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), kColorExponent);
}

/// Distances up to 0.4 of the largest fill [0, 0.95]: large ones all look alike.
float redistribute(float e, float largest) {
  constexpr float kKnee = 0.4f, kAtKnee = 0.95f;
  const float knee = kKnee * largest;
  if (e < knee) return kAtKnee / knee * e;
  return kAtKnee + (e - knee) / (largest - knee) * (1 - kAtKnee);
}

/// Difference of a feature's strength |(x, y)| in both pictures.
float feature_difference(float ax, float ay, float bx, float by) {
  return std::abs(std::sqrt(ax * ax + ay * ay) - std::sqrt(bx * bx + by * by));
}

float flip_of_pixel(const FilteredRow& a, const FilteredRow& b, size_t x, float largest) {
  const auto color = [&](const FilteredRow& row) {
    return hunt_lab_from_rgb(
        clamp01(rgb_from_opponent({row.opponent[0][x], row.opponent[1][x], row.opponent[2][x]})));
  };
  const float color_error =
      redistribute(std::pow(hyab(color(a), color(b)), kColorExponent), largest);
  const float edge = feature_difference(a.edge[0][x], a.edge[1][x], b.edge[0][x], b.edge[1][x]);
  const float point =
      feature_difference(a.point[0][x], a.point[1][x], b.point[0][x], b.point[1][x]);
  const float feature_error = std::sqrt(std::max(edge, point) * 0.70710678f);
  return std::min(std::pow(color_error, 1 - feature_error), 1.0f);
}

bool is_cancelled(const Progress* progress) { return progress && progress->cancelled(); }

OpponentImage opponent_image(const Image& image, const Progress* progress) {
  OpponentImage out(image.width, image.height);
  parallel_for(size_t(image.height), 16, [&](size_t begin, size_t end) {
    if (is_cancelled(progress)) return;
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < image.width; ++x) {
        const Vec3 o = opponent_from_rgb(clamp01(image.rgb(x, y)));
        const size_t i = size_t(y) * size_t(image.width) + size_t(x);
        out.plane[0][i] = o.x, out.plane[1][i] = o.y, out.plane[2][i] = o.z;
      }
  });
  return out;
}

/// The papers' approximation of the ACES curve, c0 + c1 x + c2 x^2 over another: [Narkowicz16] with
/// its exposure of 0.6 inside.
constexpr std::array<double, 3> kCurveAbove{0, 0.6 * 0.03, 0.6 * 0.6 * 2.51};
constexpr std::array<double, 3> kCurveBelow{0.14, 0.6 * 0.59, 0.6 * 0.6 * 2.43};

float filmic(double x) {
  x = std::clamp(x, 0.0, 1e30);
  const auto& n = kCurveAbove;
  const auto& d = kCurveBelow;
  return float(std::min((n[0] + x * (n[1] + x * n[2])) / (d[0] + x * (d[1] + x * d[2])), 1.0));
}

/// The x > 0 at which the curve has the value t: (n2 - t d2) x^2 + (n1 - t d1) x + (n0 - t d0) = 0.
double filmic_inverse(double t) {
  const double a = kCurveAbove[2] - t * kCurveBelow[2], b = kCurveAbove[1] - t * kCurveBelow[1],
               c = kCurveAbove[0] - t * kCurveBelow[0];
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

Image exposed(const Image& image, double exposure, const Progress* progress) {
  Image out(image.width, image.height, 3);
  const double factor = std::exp2(exposure);
  parallel_for(size_t(image.height), 16, [&](size_t begin, size_t end) {
    if (is_cancelled(progress)) return;
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) out.at(x, y)[c] = filmic(factor * double(image.at(x, y)[c]));
  });
  return out;
}

/// The luminances of the covered pixels by their rank, without sorting or storing them: the bits of
/// floats of 0 or more are in the order of their values, so that the upper half of a rank's bits is
/// found by counting, and then the lower half among those that share the upper one.
struct CoveredLuminance {
  const Image& image;
  const Mask& covered;
  const Progress* progress;

  template <class Visit>
  void visit_all(const Visit& visit) const {
    for (int y = 0; y < image.height && !is_cancelled(progress); ++y)
      for (int x = 0; x < image.width; ++x)
        if (covered[size_t(y) * size_t(image.width) + size_t(x)])
          // Adding 0 makes -0 to 0.
          visit(std::bit_cast<uint32_t>(std::max(luminance(image.rgb(x, y)), 0.0f) + 0.0f));
  }
  size_t count() const {
    return size_t(std::count_if(covered.begin(), covered.end(), [](uint8_t c) { return c != 0; }));
  }
  float at_rank(size_t rank) const {
    const auto find = [&](const std::vector<size_t>& counts) {
      uint32_t k = 0;
      while (k + 1 < counts.size() && rank >= counts[k]) rank -= counts[k++];
      return k;
    };
    std::vector<size_t> upper(1u << 16), lower(1u << 16);
    visit_all([&](uint32_t bits) { ++upper[bits >> 16]; });
    const uint32_t high = find(upper);
    visit_all([&](uint32_t bits) {
      if (bits >> 16 == high) ++lower[bits & 0xffff];
    });
    return std::bit_cast<float>(high << 16 | find(lower));
  }
};

}  // namespace

Image flip(const Image& a, const Image& b, const FlipParams& params) {
  LUXEL_CHECK(a.width == b.width && a.height == b.height && a.width > 0 && a.height > 0);
  LUXEL_CHECK(a.channels >= 3 && b.channels >= 3);
  LUXEL_CHECK(params.pixels_per_degree > 0);
  const FlipFilters filters = make_flip_filters(params.pixels_per_degree);
  const OpponentImage opponent_a = opponent_image(a, params.progress);
  const OpponentImage opponent_b = opponent_image(b, params.progress);
  const float largest = largest_color_difference();
  Image map(a.width, a.height, 1);
  // A band shares the horizontally filtered rows of its neighbourhood.
  constexpr size_t kBand = 64;
  parallel_for(size_t(a.height), kBand, [&](size_t begin, size_t end) {
    if (is_cancelled(params.progress)) return;
    const FilteredBand band_a(filters, opponent_a, int(begin), int(end));
    const FilteredBand band_b(filters, opponent_b, int(begin), int(end));
    FilteredRow row_a(a.width), row_b(a.width);
    for (int y = int(begin); y < int(end) && !is_cancelled(params.progress); ++y) {
      band_a.filter_row(y, row_a);
      band_b.filter_row(y, row_b);
      for (int x = 0; x < a.width; ++x)
        *map.at(x, y) = flip_of_pixel(row_a, row_b, size_t(x), largest);
      if (params.progress) params.progress->advance(1);
    }
  });
  return map;
}

FlipExposures flip_exposures(const Image& reference, const Mask& covered,
                             const Progress* progress) {
  LUXEL_CHECK(covered.size() == size_t(reference.width) * size_t(reference.height));
  const CoveredLuminance values{reference, covered, progress};
  const size_t n = values.count();
  if (n == 0) return {};
  const double brightest = double(values.at_rank(n - 1));
  if (!(brightest > 0)) return {};
  const double median = 0.5 * (double(values.at_rank((n - 1) / 2)) + double(values.at_rank(n / 2)));
  if (is_cancelled(progress)) return {};
  const double target = filmic_inverse(0.85);
  FlipExposures out;
  out.start = std::log2(target / brightest);
  out.stop = std::log2(target / std::max(median, brightest * 0x1p-20));
  out.count = std::max(2, int(std::ceil(out.stop - out.start)));
  return out;
}

Image hdr_flip(const Image& a, const Image& b, const FlipExposures& exposures,
               const FlipParams& params) {
  LUXEL_CHECK(exposures.count >= 1);
  Image largest(a.width, a.height, 1);
  const double step = (exposures.stop - exposures.start) / std::max(exposures.count - 1, 1);
  for (int i = 0; i < exposures.count && !is_cancelled(params.progress); ++i) {
    const double exposure = exposures.start + i * step;
    const Image map =
        flip(exposed(a, exposure, params.progress), exposed(b, exposure, params.progress), params);
    for (size_t k = 0; k < map.data.size(); ++k)
      largest.data[k] = std::max(largest.data[k], map.data[k]);
  }
  return largest;
}

Image with_uncovered_of(const Image& a, const Image& b, const Mask& covered) {
  LUXEL_CHECK(a.data.size() == b.data.size() && a.channels == b.channels);
  Image out = a;
  const size_t channels = size_t(a.channels);
  for (size_t i = 0; i < covered.size(); ++i)
    if (!covered[i])
      for (size_t c = 0; c < channels; ++c) out.data[channels * i + c] = b.data[channels * i + c];
  return out;
}

}  // namespace luxel::image
