#include "luxel/solve/matrix/bc1_picture.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/parallel.h"

namespace luxel::matrix {
namespace {

/// Rows that a task takes.
constexpr size_t kPictureRows = 16;
/// Steps of a fitted range, and what no row may lose more than.
constexpr size_t kLongestRange = 25;
constexpr float kLostShare = 0.002f;

uint8_t byte_of(float value, float largest, float log_range) {
  if (!(value > 0)) return 0;
  const float level = (std::log(value / largest) / log_range + 1) * 255;
  return uint8_t(std::lround(std::clamp(level, 0.0f, 255.0f)));  // infinite if the rest is none
}

/// The largest entry of every channel that is not kept.
std::array<float, 3> largest_of_rest(const ColourMatrix& matrix, const Picture& picture) {
  const size_t n = matrix.n;
  std::vector<Rgb> of_row(n);
  parallel_for(n, kPictureRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      std::array<float, 3> largest{};
      for (size_t c = 0; c < 3; ++c)
        for (size_t j = 0; j < n; ++j)
          if (!picture.is_kept(i, j))
            largest[c] = std::max(largest[c], matrix.channel[c][i * n + j]);
      of_row[i] = {largest[0], largest[1], largest[2]};
    }
  });
  Rgb all{};
  for (const Rgb& row : of_row) all = max(all, row);
  return {all.x, all.y, all.z};
}

/// The shortest range that loses no row and channel more than kLostShare of its sum.
float fitted_range(const ColourMatrix& matrix, const Picture& picture, const Progress& progress) {
  const size_t n = matrix.n;
  std::vector<size_t> of_row(n, 1);
  parallel_for(n, kPictureRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end && !progress.cancelled(); ++i)
      for (size_t c = 0; c < 3; ++c) {
        // The sums of entries between e^-(k + 1) and e^-k of the maximum.
        std::array<float, kLongestRange + 1> sum{};
        float all = 0;
        for (size_t j = 0; j < n; ++j) {
          const float entry = matrix.channel[c][i * n + j];
          all += entry;
          if (picture.is_kept(i, j) || !(entry > 0)) continue;
          const float fall = std::log(picture.largest[c] / entry);
          sum[std::min(size_t(fall), kLongestRange)] += entry;
        }
        float lost = 0;
        size_t range = kLongestRange + 1;
        while (range > 1 && lost + sum[range - 1] <= kLostShare * all) lost += sum[--range];
        of_row[i] = std::max(of_row[i], std::min(range, kLongestRange));
      }
  });
  return float(n > 0 ? *std::max_element(of_row.begin(), of_row.end()) : 1);
}

}  // namespace

std::vector<Rgb> even_columns(ColourMatrix& matrix) {
  const size_t n = matrix.n;
  std::vector<std::array<double, 3>> sum(n);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < n; ++i)
      for (size_t j = 0; j < n; ++j) sum[j][c] += double(matrix.channel[c][i * n + j]);
  std::vector<Rgb> mean(n);
  for (size_t j = 0; j < n; ++j) {
    const auto of = [&](size_t c) { return sum[j][c] > 0 ? float(sum[j][c] / double(n)) : 1.0f; };
    mean[j] = {of(0), of(1), of(2)};
  }
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < n; ++i)
      for (size_t j = 0; j < n; ++j) matrix.channel[c][i * n + j] /= mean[j][int(c)];
  return mean;
}

KeptColumns choose_kept(const ColourMatrix& matrix, float share, const Progress& progress) {
  const size_t n = matrix.n;
  const auto count = std::ptrdiff_t(std::ceil(double(share) * double(n)));
  KeptColumns out(n);
  parallel_for(n, kPictureRows, [&](size_t begin, size_t end) {
    std::vector<uint32_t> order(n);
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      for (size_t c = 0; c < 3; ++c) {
        const float* entry = matrix.channel[c].data() + i * n;
        std::iota(order.begin(), order.end(), 0u);
        std::nth_element(order.begin(), order.begin() + count, order.end(),
                         [&](uint32_t a, uint32_t b) {
                           return entry[a] != entry[b] ? entry[a] > entry[b] : a < b;
                         });
        out[i].insert(out[i].end(), order.begin(), order.begin() + count);
      }
      std::sort(out[i].begin(), out[i].end());
      out[i].erase(std::unique(out[i].begin(), out[i].end()), out[i].end());
    }
  });
  return out;
}

Picture picture_of(const ColourMatrix& matrix, const KeptColumns& kept, Bc1Params& params,
                   const Progress& progress) {
  const size_t n = matrix.n;
  Picture out{n, std::vector<uint8_t>(4 * n * n, 255), {}};
  for (size_t i = 0; i < n; ++i)
    for (const uint32_t j : kept[i]) out.at(i, j)[3] = 0;
  out.largest = largest_of_rest(matrix, out);
  if (params.log_range == 0) params.log_range = fitted_range(matrix, out, progress);
  parallel_for(n, kPictureRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end && !progress.cancelled(); ++i)
      for (size_t j = 0; j < n; ++j)
        for (size_t c = 0; c < 3; ++c)
          out.at(i, j)[c] =
              params.hole == Bc1Params::Hole::zero && out.is_kept(i, j)
                  ? uint8_t(0)
                  : byte_of(matrix.channel[c][i * n + j], out.largest[c], params.log_range);
  });
  return out;
}

}  // namespace luxel::matrix
