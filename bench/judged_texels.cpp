#include "bench/judged_texels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/random.h"
#include "luxel/light/supersample.h"
#include "luxel/reference/path_tracer.h"

namespace luxel::bench {
namespace {

constexpr size_t kJudged = 2500;
/// As a bake by the path tracer has them.
constexpr int kPointsOfFootprint = 16;
/// Other points and paths than those of any bake that is judged, whose seed is 1.
constexpr uint64_t kFirstSeed = 1001;

/// Points of some texels, those of each after those of the one before.
struct SomePoints {
  std::vector<Vec3> position, normal, geometric_normal;
  std::vector<uint32_t> first{0};

  void add(const transport::Elements& from, size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      position.push_back(from.position[k]), normal.push_back(from.normal[k]);
      geometric_normal.push_back(from.geometric_normal[k]);
    }
    first.push_back(uint32_t(position.size()));
  }
};

}  // namespace

std::vector<size_t> some_texels(size_t count) {
  std::vector<size_t> all(count);
  std::iota(all.begin(), all.end(), 0);
  const size_t kept = std::min(kJudged, count);
  for (size_t i = 0; i < kept; ++i) std::swap(all[i], all[i + hash64(1, i) % (count - i)]);
  all.resize(kept);
  std::sort(all.begin(), all.end());
  return all;
}

Result<JudgedTexels> judge_texels(const pipeline::Bake& bake, int paths_each) {
  Progress progress;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const transport::Elements elements =
      transport::elements_from_texels(bake.scene, bake.atlas, bake.map);
  const light::Lights lights = light::collect_lights(bake.scene);
  const light::TexelScene in{bake.scene, bake.atlas, bake.map, elements, lights, tracer};
  JudgedTexels out;
  out.texels = some_texels(elements.size());
  out.hidden.resize(out.texels.size());
  for (int half = 0; half < 2; ++half) {
    const uint64_t seed = kFirstSeed + uint64_t(half);
    LUXEL_TRY(const light::Footprints points,
              light::footprints(in, kPointsOfFootprint, seed, progress));
    SomePoints some;
    for (const size_t i : out.texels) some.add(points.points, points.first[i], points.first[i + 1]);
    LUXEL_TRY(reference::TexelPaths paths,
              reference::irradiance_by_paths(
                  bake.scene, {some.position, some.normal, some.geometric_normal, some.first},
                  tracer, {.samples = paths_each, .seed = seed}, progress));
    for (size_t k = 0; k < out.hidden.size(); ++k) out.hidden[k] |= paths.enclosed[k];
    out.light[size_t(half)] = std::move(paths.irradiance);
  }
  return out;
}

double rmse_over_mean(const pipeline::Bake& bake, const JudgedTexels& judged) {
  double sum2 = 0, mean = 0, count = 0;
  for (size_t k = 0; k < judged.texels.size(); ++k) {
    const size_t i = judged.texels[k];
    if (bake.light.hidden[i] || judged.hidden[k]) continue;
    const double g = double(luminance(bake.light.irradiance[i]));
    const double a = double(luminance(judged.light[0][k])),
                 b = double(luminance(judged.light[1][k]));
    sum2 += (g - a) * (g - b), mean += 0.5 * (a + b), ++count;
  }
  return std::sqrt(std::max(sum2, 0.0) * count) / mean;
}

}  // namespace luxel::bench
