#include "luxel/image/flip_filters.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/vec_double.h"
#include "luxel/base/vectorize.h"

namespace luxel::image {
namespace {

/// A contrast sensitivity function's filter: a1 sqrt(pi / b1) exp(-pi^2 x^2 / b1) + the same with
/// a2, b2, over x in degrees. [Andersson20]
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kAchromatic{1, 0.0047, 0, 1e-5}, kRedGreen{1, 0.0053, 0, 1e-5},
    kBlueYellow{34.1, 0.04, 13.5, 0.025};

/// Taps of exp(-x^2 / (2 sigma^2)), not normalised; x and sigma in pixels.
std::vector<double> gaussian_taps(double sigma, int radius) {
  std::vector<double> taps;
  for (int x = -radius; x <= radius; ++x) taps.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
  return taps;
}

double sum_of(const std::vector<double>& taps) {
  double sum = 0;
  for (const double t : taps) sum += t;
  return sum;
}

/// A kernel without the outer taps that are too small to matter in a float.
Kernel trimmed(const std::vector<double>& taps, double scale) {
  int radius = int(taps.size() / 2);
  const size_t centre = size_t(radius);
  const auto negligible = [&](int r) { return std::abs(taps[centre + size_t(r)] * scale) < 1e-10; };
  while (radius > 0 && negligible(radius)) --radius;
  Kernel out{radius, {}};
  for (size_t i = centre - size_t(radius); i <= centre + size_t(radius); ++i)
    out.tap.push_back(float(taps[i] * scale));
  return out;
}

double sigma_pixels(double b, double pixels_per_degree) {
  return std::sqrt(b / (2 * kPiDouble * kPiDouble)) * pixels_per_degree;
}

Kernel gaussian(double b, double pixels_per_degree, int radius) {
  const auto taps = gaussian_taps(sigma_pixels(b, pixels_per_degree), radius);
  return trimmed(taps, 1 / sum_of(taps));
}

/// Scales positive taps to sum 1 and negative ones to sum -1.
Kernel balanced(std::vector<double> taps) {
  double positive = 0, negative = 0;
  for (const double t : taps) (t > 0 ? positive : negative) += std::abs(t);
  for (double& t : taps) t /= t > 0 ? positive : negative;
  return trimmed(taps, 1);
}

LUXEL_VECTOR_CLONES void add_scaled(const float* in, float weight, size_t count, float* out) {
  for (size_t i = 0; i < count; ++i) out[i] += weight * in[i];
}

/// `in` has `radius` values more on either side than `out`, which has `count`.
void convolve(const float* in, int radius, const Kernel& kernel, size_t count, float* out) {
  std::fill(out, out + count, 0.0f);
  for (int k = -kernel.radius; k <= kernel.radius; ++k)
    add_scaled(in + radius + k, kernel.tap[size_t(k + kernel.radius)], count, out);
}

}  // namespace

FlipFilters make_flip_filters(double pixels_per_degree) {
  FlipFilters f;
  // Three standard deviations of the widest filter bound them all.
  const int reach = int(std::ceil(3 * sigma_pixels(kBlueYellow.b1, pixels_per_degree)));
  f.achromatic = gaussian(kAchromatic.b1, pixels_per_degree, reach);
  f.red_green = gaussian(kRedGreen.b1, pixels_per_degree, reach);
  const std::array<double, 2> a{kBlueYellow.a1, kBlueYellow.a2}, b{kBlueYellow.b1, kBlueYellow.b2};
  std::array<double, 2> mass{};
  for (size_t i = 0; i < 2; ++i) {
    f.blue_yellow[i] = gaussian(b[i], pixels_per_degree, reach);
    const double sum = sum_of(gaussian_taps(sigma_pixels(b[i], pixels_per_degree), reach));
    mass[i] = a[i] * std::sqrt(kPiDouble / b[i]) * sum * sum;  // over the square of taps
  }
  for (size_t i = 0; i < 2; ++i) f.blue_yellow_weight[i] = float(mass[i] / (mass[0] + mass[1]));

  // The distance from peak to trough of the edge detector of the eye is 0.082 degrees: twice the
  // standard deviation of the Gaussian whose derivative it is.
  const double sigma = 0.5 * 0.082 * pixels_per_degree;
  const int radius = int(std::ceil(3 * sigma));
  const std::vector<double> g = gaussian_taps(sigma, radius);
  std::vector<double> first, second;
  for (int x = -radius; x <= radius; ++x) {
    first.push_back(-x * g[size_t(x + radius)]);
    second.push_back((x * x / (sigma * sigma) - 1) * g[size_t(x + radius)]);
  }
  // In two dimensions the sign depends on x alone and the other factor has sum 1, so positive and
  // negative parts are normalised here.
  f.smooth = trimmed(g, 1 / sum_of(g));
  f.first = balanced(first);
  f.second = balanced(second);
  f.radius = std::max(reach, radius);
  return f;
}

FilteredBand::FilteredBand(const FlipFilters& filters, const OpponentImage& image, int begin,
                           int end)
    : filters_(filters), width_(image.width), top_(begin - filters.radius) {
  const int r = filters.radius, rows = end - begin + 2 * r;
  const size_t width = size_t(width_);
  for (auto& part : parts_) part.resize(size_t(rows) * width);
  std::vector<float> padded(width + 2 * size_t(r));
  for (int i = 0; i < rows; ++i) {
    const size_t y = size_t(std::clamp(top_ + i, 0, image.height - 1));
    const auto filter = [&](size_t plane,
                            std::initializer_list<std::pair<Part, const Kernel*>> to) {
      const float* in = image.plane[plane].data() + y * width;
      std::fill(padded.begin(), padded.begin() + r, in[0]);
      std::copy(in, in + width, padded.begin() + r);
      std::fill(padded.end() - r, padded.end(), in[width - 1]);
      for (const auto& [part, kernel] : to)
        convolve(padded.data(), r, *kernel, width, parts_[part].data() + size_t(i) * width);
    };
    filter(0, {{achromatic, &filters.achromatic},
               {smooth, &filters.smooth},
               {first, &filters.first},
               {second, &filters.second}});
    filter(1, {{red_green, &filters.red_green}});
    filter(2, {{blue_yellow0, &filters.blue_yellow[0]}, {blue_yellow1, &filters.blue_yellow[1]}});
  }
}

const float* FilteredBand::row(Part part, int y) const {
  return parts_[part].data() + size_t(y - top_) * size_t(width_);
}

void FilteredBand::add_column(Part part, const Kernel& kernel, int y, float weight,
                              std::vector<float>& out) const {
  for (int k = -kernel.radius; k <= kernel.radius; ++k)
    add_scaled(row(part, y + k), weight * kernel.tap[size_t(k + kernel.radius)], out.size(),
               out.data());
}

void FilteredBand::filter_row(int y, FilteredRow& out) const {
  const auto put = [&](Part part, const Kernel& kernel, std::vector<float>& to) {
    std::fill(to.begin(), to.end(), 0.0f);
    add_column(part, kernel, y, 1, to);
  };
  put(achromatic, filters_.achromatic, out.opponent[0]);
  put(red_green, filters_.red_green, out.opponent[1]);
  std::fill(out.opponent[2].begin(), out.opponent[2].end(), 0.0f);
  add_column(blue_yellow0, filters_.blue_yellow[0], y, filters_.blue_yellow_weight[0],
             out.opponent[2]);
  add_column(blue_yellow1, filters_.blue_yellow[1], y, filters_.blue_yellow_weight[1],
             out.opponent[2]);
  put(first, filters_.smooth, out.edge[0]);
  put(smooth, filters_.first, out.edge[1]);
  put(second, filters_.smooth, out.point[0]);
  put(smooth, filters_.second, out.point[1]);
}

}  // namespace luxel::image
