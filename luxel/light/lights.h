// Everything that shines, in a form that can be sampled.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/light/light_tree.h"
#include "luxel/light/surroundings.h"
#include "luxel/scene/scene.h"

namespace luxel::light {

/// All of a triangle, as a part of it.
inline constexpr std::array<Barycentric, 3> kWholeTriangle{{{0, 0}, {1, 0}, {0, 1}}};

/// An emissive triangle of the scene in the world, or a piece of one whose texture varies.
struct TriangleLight {
  Vec3 a, b, c;  ///< counter-clockwise seen from the front, in the world
  Vec3 normal;   ///< unit, front side
  float area_m2 = 0;
  float size_m = 0;   ///< of its triangle, scene::size_for_rounding()
  Rgb mean_radiance;  ///< over the triangle, for choosing; never zero for a light that shines
  uint32_t instance = 0, triangle = 0;
  bool flipped =
      false;  ///< b and c are swapped against the mesh's corner order (mirrored instance)
  bool textured = false;  ///< its radiance varies, also because holes or glass send none
  bool two_sided = false;
  /// Where a piece lies in its triangle, whose corners turn as a, b and c do, and its number.
  std::array<Barycentric, 3> part = kWholeTriangle;
  uint32_t piece = 0;
};

/// Everything that shines in a scene, arranged for picking lights at random.
struct Lights {
  std::vector<TriangleLight> triangles;  ///< in the order of the hierarchy's leaves
  size_t emissive_triangles = 0;         ///< of the scene: those in pieces count once
  std::vector<LightNode> nodes;          ///< of the triangles; node 0 is the root
  std::vector<scene::PunctualLight> punctual;
  std::vector<uint32_t> punctual_order;       ///< point and spot lights as leaves of punctual_nodes
  std::vector<LightNode> punctual_nodes;      ///< of those with any light
  std::vector<scene::LightProfile> profiles;  ///< what lights refer to
  Surroundings around;                        ///< what rays see that leave the scene
};

/// Finds the emissive triangles, cuts those with a texture by its brightness (textured_lights.h)
/// and builds the hierarchies. A light with no power is left out.
Lights collect_lights(const scene::Scene& scene);

/// Emitted radiance at a point of a triangle light, given in a, b and c, as the mean over what
/// covers it and what not.
Rgb radiance_at(const scene::Scene& scene, const TriangleLight& light, Barycentric at);

/// Irradiance on a surface that faces the light squarely at `position`, nothing in between
/// [W/m^2], and the unit direction towards the light (for a directional light, its centre).
struct PunctualIncidence {
  Rgb irradiance;
  Vec3 towards;
  float reach_m = INFINITY;  ///< both::reach_of_shadow_ray
};
/// Point and spot: I / d^2 times glTF's range window and cone falloff [KHR_lights_punctual]; I of a
/// light with a profile is that of the direction. `profiles` are the scene's.
PunctualIncidence incidence_at(const scene::PunctualLight& light,
                               std::span<const scene::LightProfile> profiles, Vec3 position);

}  // namespace luxel::light
