#include "luxel/pipeline/solver/sharing_error.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/atlas/shared_parts.h"
#include "luxel/base/random.h"
#include "luxel/pipeline/solver/texel_light.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/transport/elements_at.h"

namespace luxel::pipeline {
namespace {

/// Parts that paths start at, and paths of each of two answers. Charts that share a texel mostly
/// have light that differs by its own size: then the mean square is known to a tenth of itself.
constexpr size_t kMostParts = 500;
constexpr int kPathsPerPart = 256;
/// Any number: it sets these random numbers apart from those of other checks.
constexpr uint64_t kSharingSeed = 0x54a2e;

/// Some of the parts, by their areas, at equal steps along their sum.
std::vector<atlas::SharedPart> choose_parts(std::span<const atlas::SharedPart> all, double area) {
  std::vector<atlas::SharedPart> out;
  const double step = area / double(std::min(all.size(), kMostParts));
  double next = 0.5 * step, sum = 0;
  for (const atlas::SharedPart& part : all)
    for (sum += double(part.area); next < sum; next += step) out.push_back(part);
  return out;
}

}  // namespace

Result<double> sharing_error(const light::TexelScene& in, const TexelLight& light,
                             const CheckParams& params, Progress& progress) {
  const std::vector<atlas::SharedPart> all = atlas::shared_parts(in.atlas, in.map);
  double area = 0, texels = 0;
  for (const atlas::SharedPart& part : all) area += double(part.area);
  for (const uint8_t hidden : light.hidden) texels += !hidden;
  const double mean = mean_light(light);
  if (!(area > 0 && mean > 0)) return 0.0;
  const std::vector<atlas::SharedPart> chosen = choose_parts(all, area);
  std::vector<scene::SurfacePoint> middles;
  for (const atlas::SharedPart& part : chosen) middles.push_back(part.middle);
  const transport::Elements places = transport::elements_at(in.scene, middles);
  progress.begin("check", 2);
  std::array<reference::TexelPaths, 2> answers;
  for (size_t k = 0; k < answers.size(); ++k) {
    LUXEL_TRY_STATUS(stopped(progress));
    Progress own;  // its stages are those of the check
    const uint64_t seed = hash64(hash64(params.seed, kSharingSeed), k);
    LUXEL_TRY(answers[k],
              reference::irradiance_by_paths(in.scene, reference::receivers(places), in.tracer,
                                             {kPathsPerPart, params.bounces, seed}, own));
    progress.advance(1);
  }
  double squares = 0;
  for (size_t k = 0; k < chosen.size(); ++k) {
    if (answers[0].enclosed[k] && answers[1].enclosed[k]) continue;
    const auto off = [&](const reference::TexelPaths& answer) {
      return double(luminance(light.irradiance[chosen[k].texel] - answer.irradiance[k]));
    };
    squares += off(answers[0]) * off(answers[1]) * (area / double(chosen.size()));
  }
  return std::sqrt(std::max(0.0, squares) / texels) / mean;
}

}  // namespace luxel::pipeline
