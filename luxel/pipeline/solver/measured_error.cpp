#include "luxel/pipeline/solver/measured_error.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "luxel/base/clock.h"
#include "luxel/base/random.h"
#include "luxel/pipeline/solver/upper_mean.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/transport/back_faces.h"

namespace luxel::pipeline {
namespace {

/// Texels of the first round: the mean square of errors of one size is known to sqrt(2 / 600) = 6 %
/// of itself by so many.
constexpr size_t kCheckTexels = 600;
/// Paths per texel and answer of the first round, and so many times as many paths in all. Light
/// that varies by its own size between paths is known to 1 / sqrt(512) = 4 % at each of 600 texels;
/// the product of two such errors has the mean 0, and it adds 0.04 / 600^(1/4) = 0.9 % of the
/// light.
constexpr int kCheckPaths = 32;
constexpr size_t kCheckTimes = 16;
/// Rounds end when the largest error that is likely is so many times the likeliest one.
constexpr double kCheckKnown = 1.2;

/// A texel that is looked at, and what it counts.
struct CheckedTexel {
  uint32_t texel = 0;
  double weight = 1;
};

double light_at(const TexelLight& light, size_t i) {
  return double(luminance(light.irradiance[i]));
}

/// About `count` of the texels `seen`, by their light: half of the probability is the same for
/// each, half goes with its light, since errors mostly do. They are taken at equal steps of the
/// probability's sum, so they are spread over the charts; `first` says where in a step.
std::vector<CheckedTexel> choose_texels(const TexelLight& light, std::span<const uint32_t> seen,
                                        size_t count, double first) {
  double mean = 0;
  for (const uint32_t i : seen) mean += light_at(light, i) / double(seen.size());
  std::vector<CheckedTexel> out;
  const double step = double(seen.size()) / double(count);
  double next = first * step, sum = 0;
  for (const uint32_t i : seen) {
    const double density = mean > 0 ? 0.5 + 0.5 * light_at(light, i) / mean : 1;
    sum += density;
    for (; next < sum; next += step) out.push_back({i, 1 / density});
  }
  return out;
}

/// The light that paths have found so far, per texel that is looked at.
struct PathAnswers {
  std::vector<CheckedTexel> chosen;
  std::vector<double> first, second;  ///< sums of luminance over paths [W/m^2]
  std::vector<transport::BackFaces> backs;
  int paths = 0;  ///< per texel and answer

  void add(std::span<const CheckedTexel> more) {
    chosen.insert(chosen.end(), more.begin(), more.end());
    first.resize(chosen.size()), second.resize(chosen.size()), backs.resize(chosen.size());
  }
  std::pair<double, double> at(size_t k) const { return {first[k] / paths, second[k] / paths}; }
};

/// `more` paths for both answers of the texels from the one with the index `begin` on.
Status trace_more(const light::TexelScene& in, size_t begin, int more, const CheckParams& params,
                  PathAnswers& answers, Progress& progress) {
  std::vector<uint32_t> texels;
  for (size_t k = begin; k < answers.chosen.size(); ++k) texels.push_back(answers.chosen[k].texel);
  const transport::Elements points = transport::subset(in.elements, texels);
  for (const int which : {0, 1}) {
    // No other paths begin at so many texels with as many before them.
    const uint64_t round = hash64(begin, uint64_t(2 * answers.paths + which));
    LUXEL_TRY(const reference::TexelPaths traced,
              reference::irradiance_by_paths(
                  in.scene, reference::receivers(points), in.tracer,
                  {more, params.bounces, hash64(hash64(params.seed, 0xc4ec), round)}, progress));
    std::vector<double>& sums = which == 0 ? answers.first : answers.second;
    for (size_t k = 0; k < points.size(); ++k) {
      sums[begin + k] += double(more) * double(luminance(traced.irradiance[k]));
      transport::BackFaces& backs = answers.backs[begin + k];
      backs.rays += more;
      backs.one_sided += int(traced.met_back[k]);
      backs.double_sided += int(traced.met_double_sided_back[k]);
    }
  }
  return {};
}

/// The mean square of errors over the square of the mean light.
struct SquareError {
  double likeliest = 0, largest = 0;
  /// True: the error varies more from texel to texel than by the paths' noise.
  bool varies = false;
};

/// Texels inside of solids do not count. `mean_light` is that of the solver, over all texels.
SquareError square_error(const TexelLight& light, double mean_light, const PathAnswers& answers) {
  std::vector<double> square;
  double off = 0, weights = 0, sum = 0, squares = 0, noise = 0;
  for (size_t k = 0; k < answers.chosen.size(); ++k) {
    if (transport::is_enclosed(answers.backs[k])) continue;
    const double g = light_at(light, answers.chosen[k].texel), w = answers.chosen[k].weight;
    const auto [a, b] = answers.at(k);
    const double s = (g - a) * (g - b), variance = 0.5 * (a - b) * (a - b);
    square.push_back(w * s);
    weights += w, off += w * (0.5 * (a + b) - g), sum += w * s, squares += w * s * w * s;
    // (d - x)(d - y) of noises x and y varies by 2 d^2 Var x + (Var x)^2.
    noise += w * w * variance * (2 * std::max(0.0, s) + variance);
  }
  if (square.empty()) return {};
  // The mean light is that of all texels, corrected by what these are off.
  const double mean = mean_light + off / weights;
  if (!(mean > 0)) return {};
  const double scale = double(square.size()) / (weights * mean * mean);
  const double found = sum / double(square.size()), margin = upper_mean(square) - found;
  // By the noise of the paths, squares may be below 0 in the mean: then nothing was found.
  const double likeliest = std::max(0.0, found);
  return {likeliest * scale, (likeliest + margin) * scale, squares > 2 * noise};
}

}  // namespace

Result<double> measured_error(const light::TexelScene& in, const TexelLight& light,
                              const CheckParams& params, Progress& progress) {
  const auto start = Clock::now();
  std::vector<uint32_t> seen;
  double mean_light = 0;
  for (size_t i = 0; i < light.irradiance.size(); ++i)
    if (!light.hidden[i]) seen.push_back(uint32_t(i)), mean_light += light_at(light, i);
  if (seen.empty()) return 0.0;
  mean_light /= double(seen.size());
  // All texels, or some of many.
  PathAnswers answers;
  size_t count = kCheckTexels;
  if (2 * count > seen.size())
    for (const uint32_t i : seen) answers.add(std::array{CheckedTexel{i, 1}});
  else
    answers.add(choose_texels(light, seen, count, 0.5));
  LUXEL_TRY_STATUS(trace_more(in, 0, kCheckPaths, params, answers, progress));
  answers.paths = kCheckPaths;
  // Each round doubles the paths: at other texels, where errors vary from texel to texel, or else
  // at the same ones.
  for (size_t times = 1;; times *= 2) {
    const SquareError e = square_error(light, mean_light, answers);
    const bool known = e.largest <= kCheckKnown * kCheckKnown * e.likeliest;
    if (known || times == kCheckTimes || 2 * seconds_since(start) > params.seconds)
      return std::sqrt(e.largest);
    size_t begin = 0;
    const int more = answers.paths;
    if (e.varies && 2 * count <= seen.size()) {
      // Between those that are chosen already: at 1/2 of the first steps, at 0 of these, and then
      // at 1/2 of steps half as large.
      begin = answers.chosen.size();
      answers.add(choose_texels(light, seen, count, count == kCheckTexels ? 0 : 0.5));
      count *= 2;
    }
    LUXEL_TRY_STATUS(trace_more(in, begin, more, params, answers, progress));
    if (begin == 0) answers.paths += more;
  }
}

}  // namespace luxel::pipeline
