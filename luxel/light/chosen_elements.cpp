#include "luxel/light/chosen_elements.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/random.h"

namespace luxel::light {
namespace {

/// Any number: it sets the choice apart from other random numbers of the same seed.
constexpr uint64_t kChoiceSeed = 0x4e9ea7;

}  // namespace

Chances chances_of(std::span<const float> variance, const IsHidden& is_hidden) {
  Chances out;
  for (size_t i = 0; i < variance.size(); ++i)
    if (!is_hidden(i)) out.all += double(variance[i]), out.count += 1;
  return out;
}

std::vector<uint32_t> choose_elements(std::span<const float> variance, const IsHidden& is_hidden,
                                      const Chances& chances, size_t count, uint64_t seed) {
  std::vector<uint32_t> out;
  double sum = 0;
  const double first = double(unit_float(uint32_t(hash64(seed, kChoiceSeed))));
  for (uint32_t i = 0; i < variance.size(); ++i) {
    if (is_hidden(i)) continue;
    sum += chances.of(variance[i]) * double(count);
    while (out.size() < count && double(out.size()) + first < sum) out.push_back(i);
  }
  return out;
}

Chosen chosen_of(const TexelScene& in, std::span<const uint32_t> drawn) {
  Chosen out;
  std::ranges::unique_copy(drawn, std::back_inserter(out.elements));
  out.map.resolution = in.map.resolution;
  out.map.texel_at.assign(in.map.texel_at.size(), atlas::kNone);
  for (const uint32_t i : out.elements) {
    const atlas::Texel& texel = in.map.texels[i];
    out.map.texel_at[size_t(texel.y) * size_t(in.map.resolution) + size_t(texel.x)] =
        uint32_t(out.map.texels.size());
    out.map.texels.push_back(texel);
  }
  out.places = transport::elements_from_texels(in.scene, in.atlas, out.map);
  return out;
}

Answers answers_for(std::span<const uint32_t> drawn, std::span<const float> variance,
                    const Chances& chances) {
  Answers out;
  for (const uint32_t i : drawn) {
    const double weight = 1 / (chances.of(variance[i]) * chances.count * double(drawn.size()));
    if (!out.elements.empty() && out.elements.back() == i)
      out.weight.back() += weight;
    else
      out.elements.push_back(i), out.weight.push_back(weight);
  }
  return out;
}

MeanSquare square_error(const Answers& answers, std::span<const Rgb> irradiance) {
  const size_t n = answers.elements.size();
  LUXEL_CHECK(answers.first.size() == n && answers.second.size() == n);
  MeanSquare out;
  double squares = 0;
  for (size_t k = 0; k < n; ++k) {
    const Rgb g = irradiance[answers.elements[k]];
    const double part = answers.weight[k] * double(luminance(g - answers.first[k])) *
                        double(luminance(g - answers.second[k]));
    out.mean += part, squares += part * part;
  }
  if (n > 0)
    out.standard_error = std::sqrt(std::max(0.0, squares - out.mean * out.mean / double(n)));
  return out;
}

Result<std::vector<Rgb>> direct_anew(const TexelScene& in, const SupersampleParams& params,
                                     Progress& progress) {
  DirectParams at_sample = params.direct;
  if (params.points > 1) at_sample.samples = 1;  // only what has no points keeps it
  LUXEL_TRY(DirectLight out, direct_light(lit_elements(in), at_sample, progress));
  std::vector<uint32_t> all(in.elements.size());
  std::iota(all.begin(), all.end(), 0);
  if (params.points > 1) LUXEL_TRY_STATUS(average_texels(in, all, params, out, progress));
  return std::move(out.irradiance);
}

}  // namespace luxel::light
