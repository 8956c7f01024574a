#include "luxel/solve/gather/budget/light_errors.h"

#include <algorithm>

#include "luxel/base/free_memory.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/budget/error_p95.h"
#include "luxel/solve/gather/budget/expected_rms.h"
#include "luxel/solve/gather/budget/texel_error.h"

namespace luxel::gather {
namespace {

/// The error that texels add to gathered light. Errors: the file of hits cannot be read, cancelled.
Result<TexelError> error_of_texels(const light::TexelScene& scene, const LightToJudge& light,
                                   Progress& progress) {
  const std::vector<Rgb>& e = light.bounced.irradiance;
  ReadError measured;
  if (light.check) {
    LUXEL_TRY(measured,
              read_error(*light.check, {scene.map, scene.elements, light.hits, light.behind, e},
                         progress));
  }
  return texel_error(error_by_neighbours(scene.atlas, scene.map, scene.elements, light.hits,
                                         light.direct.irradiance, e),
                     measured);
}

/// Bounces carry noise on: the mean of the noise of n elements, whose variance is an nth of theirs,
/// becomes `gain` times as large in all of them. In bright rooms that is most of it.
void add_shared_noise(double gain, const TracedHits& hits, LightErrors& out) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < out.noise_variance.size(); ++i)
    if (!is_hidden(hits, i)) sum += double(out.noise_variance[i]), count += 1;
  if (count == 0) return;
  const double shared = (gain * gain - 1) / count;
  for (float& v : out.variance) v += float(shared * sum / count);
  out.expected.noise *= 1 + shared, out.expected.shared_of_noise = shared / (1 + shared);
}

}  // namespace

Result<LightErrors> light_errors(const light::TexelScene& scene, const LightToJudge& light,
                                 Progress& progress) {
  const std::vector<Rgb>& e = light.bounced.irradiance;
  // First, while nothing else is there: it takes a radiosity map.
  TexelError texels;
  if (light.bounces != 0) {
    LUXEL_TRY(texels, error_of_texels(scene, light, progress));
  }
  auto direct = pooled_variances(scene.atlas, scene.map,
                                 {light.direct.variance, light.direct.split_variance});
  auto gathered = pooled_variances(scene.atlas, scene.map,
                                   {light.bounced.variance, light.bounced.split_variance});
  LightErrors out;
  out.direct = relative_errors(direct, e, light.hits);
  out.gathered = relative_errors(gathered, e, light.hits);
  out.noise_variance = std::move(direct);
  for (size_t i = 0; i < gathered.size(); ++i) out.noise_variance[i] += gathered[i];
  free_memory(gathered);
  const auto counts = [&](size_t i) { return !is_hidden(light.hits, i); };
  out.all = relative_errors(out.noise_variance, e, light.hits);
  out.noise_p95 = error_p95(out.all, counts);
  const auto gathered_light = [&](size_t i) {
    return double(luminance(e[i] - source_of(light.hits, light.direct.irradiance, i)));
  };
  const auto apart_of = [&](size_t i) {
    const std::vector<float>& by_chart = texels.relative_square_apart;
    if (by_chart.empty()) return 0.0;
    return double(by_chart[scene.atlas.chart[scene.map.texels[i].triangle_number]]);
  };
  // Squares over that of gathered light.
  const double apart2 = texels.apart * texels.apart;
  const double safe2 = texels.safe * texels.safe + apart2;
  const double likely2 = texels.likely * texels.likely + apart2;
  out.variance = out.noise_variance;
  for (size_t i = 0; i < e.size(); ++i)
    out.variance[i] += float(safe2 * gathered_light(i) * gathered_light(i));
  out.expected = expected_squares(
      e, {out.noise_variance, out.variance, safe2 > 0 ? likely2 / safe2 : 0}, light.hits);
  // Relative errors are larger where less light is gathered.
  const double darkest = double(darkest_light(e));
  for (size_t i = 0; i < e.size(); ++i) {
    const double shared = texels.safe * gathered_light(i);
    const double own = std::max(double(luminance(e[i])), darkest);
    const double apart = apart_of(i) * own * own;
    out.variance[i] = out.noise_variance[i] + float(shared * shared + apart);
  }
  add_shared_noise(texels.gain, light.hits, out);
  free_memory(out.all);
  out.all = relative_errors(out.variance, e, light.hits);
  out.p95 = error_p95(out.all, counts);
  return out;
}

}  // namespace luxel::gather
