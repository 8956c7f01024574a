#include "luxel/pipeline/solver/measured_error.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "luxel/base/clock.h"
#include "luxel/base/random.h"
#include "luxel/pipeline/solver/upper_mean.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/transport/back_faces.h"

namespace luxel::pipeline {
namespace {

/// Texels that are looked at: half of them are spread evenly, half as the light is. The mean square
/// of errors of one size is known to sqrt(2 / 600) = 6 % of itself.
constexpr size_t kTexels = 600;
/// Paths per texel and answer: of the first round, and of all of them. Light that varies by its own
/// size between paths is known to 1 / sqrt(512) = 4 % at each texel; the product of two such errors
/// has the mean 0, and over 600 texels it adds 0.04 / 600^(1/4) = 0.9 % of the light to the answer.
constexpr int kFirstPaths = 32, kMostPaths = 512;
/// Paths are added until the largest error that is likely is so many times the likeliest one.
constexpr double kKnown = 1.2;

/// A texel that is looked at, and what it counts.
struct Chosen {
  uint32_t texel = 0;
  double weight = 1;
};

double light_at(const TexelLight& light, size_t i) {
  return double(luminance(light.irradiance[i]));
}

/// All texels that are not hidden, or, of many, some by their light: half of the probability is the
/// same for each, half goes with its light, since errors mostly do. They are taken at equal steps of
/// the probability's sum, so they are spread over the charts.
std::vector<Chosen> choose_texels(const TexelLight& light) {
  std::vector<uint32_t> seen;
  double mean = 0;
  for (size_t i = 0; i < light.irradiance.size(); ++i)
    if (!light.hidden[i]) seen.push_back(uint32_t(i)), mean += light_at(light, i);
  std::vector<Chosen> out;
  if (seen.size() <= kTexels) {
    for (const uint32_t i : seen) out.push_back({i, 1});
    return out;
  }
  const auto n = double(seen.size());
  mean /= n;
  const double step = n / double(kTexels);
  double next = 0.5 * step, sum = 0;
  for (const uint32_t i : seen) {
    const double density = mean > 0 ? 0.5 + 0.5 * light_at(light, i) / mean : 1;
    sum += density;
    for (; next < sum; next += step) out.push_back({i, 1 / density});
  }
  return out;
}

/// Mean light of the texels that are not hidden.
double mean_of_seen(const TexelLight& light) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < light.irradiance.size(); ++i)
    if (!light.hidden[i]) sum += light_at(light, i), count += 1;
  return count > 0 ? sum / count : 0;
}

/// What paths have found so far, per texel that is looked at.
struct PathAnswers {
  std::vector<double> first, second;  ///< sums of luminance over paths [W/m^2]
  std::vector<transport::BackFaces> backs;
  int paths = 0;  ///< of each answer

  explicit PathAnswers(size_t count) : first(count), second(count), backs(count) {}
  std::pair<double, double> at(size_t k) const { return {first[k] / paths, second[k] / paths}; }
};

/// `more` paths per texel for both answers.
Status add_paths(const light::TexelScene& in, const transport::Elements& points, int more,
                 const CheckParams& params, PathAnswers& answers, Progress& progress) {
  for (const int which : {0, 1}) {
    const uint64_t seed = hash64(hash64(params.seed, 0xc4ec), uint64_t(2 * answers.paths + which));
    LUXEL_TRY(const reference::TexelPaths traced,
              reference::irradiance_by_paths(in.scene, reference::receivers(points), in.tracer,
                                             {more, params.bounces, seed}, progress));
    std::vector<double>& sums = which == 0 ? answers.first : answers.second;
    for (size_t k = 0; k < points.size(); ++k) {
      sums[k] += double(more) * double(luminance(traced.irradiance[k]));
      answers.backs[k].rays += more;
      answers.backs[k].one_sided += int(traced.met_back[k]);
      answers.backs[k].double_sided += int(traced.met_double_sided_back[k]);
    }
  }
  answers.paths += more;
  return {};
}

/// The mean square of errors over the square of the mean light, the likeliest and the largest.
struct SquareError {
  double likeliest = 0, largest = 0;
};

/// Texels inside of solids do not count.
SquareError square_error(const TexelLight& light, std::span<const Chosen> chosen,
                         const PathAnswers& answers) {
  std::vector<double> square;
  double off = 0, weights = 0, sum = 0;
  for (size_t k = 0; k < chosen.size(); ++k) {
    if (transport::is_enclosed(answers.backs[k])) continue;
    const double g = light_at(light, chosen[k].texel), w = chosen[k].weight;
    const auto [a, b] = answers.at(k);
    square.push_back(w * (g - a) * (g - b));
    weights += w, off += w * (0.5 * (a + b) - g), sum += square.back();
  }
  if (square.empty()) return {};
  // The mean light is that of all texels, corrected by what these are off.
  const double mean = mean_of_seen(light) + off / weights;
  if (!(mean > 0)) return {};
  const double scale = double(square.size()) / (weights * mean * mean);
  return {std::max(0.0, sum / double(square.size())) * scale, upper_mean(square) * scale};
}

}  // namespace

Result<double> measured_error(const light::TexelScene& in, const TexelLight& light,
                              const CheckParams& params, Progress& progress) {
  const auto start = Clock::now();
  const std::vector<Chosen> chosen = choose_texels(light);
  if (chosen.empty()) return 0.0;
  std::vector<uint32_t> texels;
  for (const Chosen& c : chosen) texels.push_back(c.texel);
  const transport::Elements points = transport::subset(in.elements, texels);
  PathAnswers answers(chosen.size());
  for (int more = kFirstPaths;; more = answers.paths) {
    const auto begun = Clock::now();
    LUXEL_TRY_STATUS(add_paths(in, points, more, params, answers, progress));
    const SquareError e = square_error(light, chosen, answers);
    const bool known = e.largest <= kKnown * kKnown * e.likeliest;
    // The next round has as many paths as all before it.
    const bool has_time = seconds_since(start) + seconds_since(begun) * answers.paths / more <=
                          params.seconds;
    if (known || 2 * answers.paths > kMostPaths || !has_time)
      return std::sqrt(std::max(0.0, e.largest));
  }
}

}  // namespace luxel::pipeline
