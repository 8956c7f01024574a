// Light that arrives at patches straight from surfaces that glow.
#pragma once

#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/solve/matrix/matrix.h"

namespace luxel::matrix {

/// Light that patches get straight from each material that they see. A small lamp is a single patch
/// or two, and as sharp as a point light: a codec or few rays make noise of it. So its light is
/// kept as it is, and codecs hold what is reflected.
struct Glow {
  std::vector<uint32_t> first;     ///< per patch, one extra entry; empty: nothing is kept
  std::vector<uint32_t> material;  ///< of the scene, ascending for each patch
  std::vector<Rgb> irradiance;     ///< E where the material's mean radiosity is 1 [1]
};

/// Mean radiosity of their own, by area, per material.
std::vector<Rgb> mean_emission_of(std::span<const Rgb> emission, std::span<const uint32_t> material,
                                  std::span<const float> area_m2, size_t materials);

/// The glow of all materials. Those that glow in the scene keep their pattern; shadow rays look for
/// their light at the probes of each patch. The light of others, should they ever glow, is that of
/// the form factors. Errors: cancelled.
Result<Glow> make_glow(const scene::Scene& scene, const trace::RayTracer& tracer,
                       const Prepared& prepared, uint64_t seed, Progress& progress);

/// Adds E to the irradiance of the patches; `radiosity` is the mean per material [W/m^2]. Allocates
/// nothing.
void add_glow(const Glow& glow, std::span<const Rgb> radiosity, std::span<Rgb> irradiance);

}  // namespace luxel::matrix
