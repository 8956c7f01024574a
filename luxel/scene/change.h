// Changes of a scene, as a second bake asks for them: rays that can meet something else than
// before, and light that is only brighter, darker or of another colour.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Facts about a scene that tell later what has changed: digests, and the values that a change is
/// measured against. Names are there to be shown; nothing compares them.
struct SceneState {
  struct Material {
    std::string name;
    /// Digest of what rays notice: where it is solid, what it lets through and in which colour,
    /// whether its back reflects. Bit 0 says whether it is double-sided, bit 1 whether it scatters
    /// light through: the places that have light of their own depend on both.
    uint64_t shape = 0;
    uint64_t colour = 0;  ///< digest of what reflectance_at and diffuse_transmittance_at look up
    uint64_t emission_shape = 0;  ///< digest of what the emission's factor is multiplied by
    Rgb emission{};               ///< that factor [W/(sr m^2)]
  };
  struct Light {
    std::string name;
    uint64_t shape = 0;  ///< digest of all but the intensity; of a profile, what it holds
    Rgb intensity{};     ///< as in PunctualLight
  };
  struct Instance {
    std::string name;
    uint32_t mesh = 0;
    Mat34 world_from_object;
    Box3 bounds;        ///< world [m], of all its triangles; empty without any
    float density = 1;  ///< layout_density()
  };
  std::vector<uint64_t> meshes;  ///< digests
  std::vector<std::string> mesh_names;
  std::vector<Instance> instances;
  std::vector<Material> materials;
  std::vector<Light> lights;
  uint64_t surroundings = 0;  ///< digest of background and environment
  /// Materials of each mesh, ascending. Equal meshes have equal ones: a state that was kept in a
  /// file and serves as `before` need not have them.
  std::vector<std::vector<uint32_t>> mesh_materials;
};
SceneState state_of(const Scene& scene);

/// Differences between two states of a scene. Cameras, names, and features that only pictures show
/// (normal maps, highlights, unlit materials) are no difference.
struct SceneChange {
  /// Not empty: something changed that cannot be followed up, in words ("mesh 'chair' has changed",
  /// "3 lights there, 4 here"). All is different then, and nothing of what follows is filled in.
  std::string beyond;
  std::vector<uint32_t> moved;  ///< instances whose transform differs
  /// Where rays may meet something else than before [m, world]: moved instances as they were and as
  /// they are; instances with a material of another shape.
  std::vector<Box3> boxes;
  std::vector<uint32_t> recoloured;  ///< materials whose `colour` differs
  /// Per light and per material: what its light is multiplied by. {1, 1, 1}: as it was; nothing: it
  /// shines otherwise than before, not by a factor per channel.
  std::vector<std::optional<Rgb>> light_scale, emission_scale;
  bool surroundings = false;       ///< background or environment differ
  std::vector<uint32_t> reshaped;  ///< materials whose `shape` differs
  /// True: something differs.
  bool any() const;
};
/// `now` is fresh from state_of.
SceneChange change_between(const SceneState& before, const SceneState& now);

/// "instance 'chair' moved, light 'desk' shines otherwise": for people, the first few. Empty where
/// nothing differs. `now` names things; the state before does as well.
std::string in_words(const SceneState& now, const SceneChange& change);

}  // namespace luxel::scene
