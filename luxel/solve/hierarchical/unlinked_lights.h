// Light that comes from no surface: punctual lights, the background.
#pragma once

#include "luxel/light/lights.h"
#include "luxel/light/shadow_rays.h"
#include "luxel/solve/hierarchical/refine.h"
#include "luxel/transport/elements.h"

namespace luxel::hierarchical {

/// Lights besides surfaces.
struct UnlinkedLights {
  light::Lights lights;  ///< no triangles
  bool has_sky = false;  ///< background or a map
  bool any() const { return has_sky || !lights.punctual.empty(); }
};
/// Punctual lights, and whatever background or map the scene has.
UnlinkedLights unlinked_lights_of(const scene::Scene& scene);

/// The scene for rays towards the sky.
struct SkyScene {
  const scene::Scene& scene;
  const light::Surroundings& around;
  const trace::RayTracer& tracer;
};
/// Cosine-distributed rays towards the sky, the same for all points with these normals, and what
/// the sky sends along them.
struct SkyRays {
  Vec3 normal{}, geometric_normal{};
  uint32_t count = 0;           ///< with those below the surface
  std::vector<Vec3> direction;  ///< those above it
  std::vector<Rgb> radiance;    ///< of the soft light of the surroundings, per direction
  std::vector<trace::Ray> rays;
  std::vector<uint8_t> blocked;
};
/// E of the soft light of the surroundings at a point [W/m^2], by `count` rays: pi / count times
/// the sum of the radiance of those that leave the scene. All points send theirs in the same
/// directions of their frames, so that E has steps but no noise. `rays` are those of the last call,
/// which stay where the normals do.
Rgb soft_sky_at(const SkyScene& sky, const light::Receiver& point, uint32_t count, SkyRays& rays);
/// The largest radiance of the soft surroundings [W/(sr m^2)]: E of the sky is at most pi times it.
float brightest_sky(const scene::Scene& scene, const light::Surroundings& around);

/// Sets ElementLight::unlinked of all leaves that have none yet, and divides leaves over which it
/// is farther than eps from linear, until none is. As with links, large leaves count for more: see
/// error_of. `off`: how far it is [W/m^2], per element; calls of one solution hand it on, so that
/// leaves are looked at once.
Status light_leaves(Refined& state, const Exchange& exchange, const UnlinkedLights& unlinked,
                    const RefineParams& params, std::vector<float>& off, Progress& progress);

}  // namespace luxel::hierarchical
