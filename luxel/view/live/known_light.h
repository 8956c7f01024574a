// Known light of a bake, from which light after an edit of its scene is estimated.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "luxel/light/texel_scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::view {

/// Light of the texels of a bake, and the scene as it was laid out for it. It stays where it is:
/// the tracer looks at the scene.
struct KnownLight {
  scene::Scene scene;
  std::optional<trace::RayTracer> tracer;  ///< of it
  bool is_apart = false;                   ///< meshes are stored once: RayTracer::moved() is quick
  atlas::Atlas atlas;
  atlas::TexelMap map;
  std::vector<uint32_t> material_as_read;  ///< per material, the one of the scene as it was read
  std::vector<Vec3> position, normal;      ///< of each texel, in the world [m]; of its triangle
  float texel_m2 = 0;                      ///< what a texel covers of surfaces in the mean
  std::vector<Rgb> irradiance;             ///< E [W/m^2]
  std::vector<Rgb> direct;                 ///< the part of it that comes straight from lights
  std::vector<Rgb> of_lamps;  ///< the part that comes straight from lamps; empty: not told apart
  /// Per texel, 1: within a solid, with light of those around it; empty: black ones may be.
  std::vector<uint8_t> hidden;
};

/// `as_read`: the scene before it was laid out. E is to be filled in. Errors: no memory.
Result<std::shared_ptr<KnownLight>> known_light(const light::TexelScene& in,
                                                const scene::Scene& as_read);

/// True: sorting all triangles of a scene anew and tracing so many rays in them takes less time
/// than RayTracer::moved() and as many rays, which then go through two levels.
bool flat_is_quicker(const scene::Scene& scene, double rays);

}  // namespace luxel::view
