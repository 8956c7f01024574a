// Everything that shines, in a form that can be sampled.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "scene/scene.h"
#include "transport/light_tree.h"
#include "transport/surroundings.h"

namespace luxel::transport {

/// An emissive triangle of the scene in the world.
struct TriangleLight {
  Vec3 a, b, c;  ///< counter-clockwise seen from the front, in the world
  Vec3 normal;   ///< unit, front side
  float area_m2 = 0;
  Rgb mean_radiance;  ///< over the triangle, for choosing; never zero for a light that shines
  uint32_t instance = 0, triangle = 0;
  bool flipped =
      false;  ///< b and c are swapped against the mesh's corner order (mirrored instance)
  bool textured = false;  ///< its radiance varies, also because holes or glass send none
  bool two_sided = false;
};

struct Lights {
  std::vector<TriangleLight> triangles;  ///< in the order of the hierarchy's leaves
  std::vector<LightNode> nodes;          ///< of the triangles; node 0 is the root
  std::vector<scene::PunctualLight> punctual;
  std::vector<uint32_t> lamp_order;           ///< point and spot lights as leaves of lamp_nodes
  std::vector<LightNode> lamp_nodes;          ///< of those with any light
  std::vector<scene::LightProfile> profiles;  ///< what lamps refer to
  Surroundings around;                        ///< what rays see that leave the scene
};

/// Finds the emissive triangles, averages their textures and builds the hierarchies. A triangle
/// with no power is left out.
Lights collect_lights(const scene::Scene& scene);

/// Emitted radiance at a point of a triangle light, as the mean over what covers it and what not.
Rgb radiance_at(const scene::Scene& scene, const TriangleLight& light, Barycentric at);

/// Irradiance on a surface that faces the light squarely at `position`, nothing in between
/// [W/m^2], and the unit direction towards the light (for a directional light, its centre).
struct PunctualIncidence {
  Rgb irradiance;
  Vec3 towards;
  float distance_m = INFINITY;
};
/// Point and spot: I / d^2 times glTF's range window and cone falloff [KHR_lights_punctual]; I of a
/// lamp with a profile is that of the direction. `profiles` are the scene's.
PunctualIncidence incidence_at(const scene::PunctualLight& light,
                               std::span<const scene::LightProfile> profiles, Vec3 position);

}  // namespace luxel::transport
