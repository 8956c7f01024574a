// A baked scene on a graphics device.
#pragma once

#include <array>
#include <deque>
#include <span>
#include <vector>

#include "luxel/gpu/pipeline.h"
#include "luxel/image/half.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/scene/scene.h"
#include "luxel/view/draw/scene_shared.h"

namespace luxel::view {

/// Pictures that the shaders of surfaces look up, in the order of their bindings: E, the base
/// colour, the metallic factor, emission, the share of light that is scattered through and its
/// colour, the second picture of E, and the maps of shadows, which tell what is lit, and then their
/// depth.
inline constexpr uint32_t kLookUps = 9;

/// Triangles of one material in one mesh: a range of the indices.
struct DrawRange {
  uint32_t first_index = 0, indices = 0;
  uint32_t material = 0;
};

/// A scene's surfaces and their light, ready to be drawn. Structs in its buffers are those of
/// scene_shared.h.
struct DeviceScene {
  gpu::Buffer vertices;                        ///< of all meshes
  gpu::Buffer indices;                         ///< 32 bits each, into all vertices
  gpu::Buffer materials;                       ///< of the scene, in its order
  gpu::Buffer instances;                       ///< world from object, and factors of emission
  std::vector<std::vector<DrawRange>> ranges;  ///< of each mesh
  std::vector<uint32_t> mesh_of;               ///< of each instance
  std::vector<uint8_t> is_mirrored;            ///< of each instance: its triangles are turned round
  std::vector<uint8_t> is_double_sided;        ///< of each material
  std::vector<uint8_t> is_masked;              ///< of each material: it has holes
  std::vector<uint8_t> scatters_through;       ///< of each material: light to its other side
  std::vector<uint8_t> glows_or_is_metal;      ///< of each material

  /// E per page of the lightmap, in two pictures: where light changes, the one fades into the
  /// other. Elsewhere they are one.
  std::array<std::vector<const gpu::Picture*>, 2> lights;
  /// on_device::LightNow, then per page, for either picture: E = scale * picture.
  gpu::Buffer light_now;
  float second_light = 0;  ///< the share of the second pictures in what is shown

  std::deque<gpu::Picture> pictures;  ///< where they lie when others are added
  std::vector<gpu::OwnedSampler> samplers;
  /// For each material what its kLookUps bindings are.
  std::vector<std::vector<gpu::Binding>> bindings;

  Box3 bounds;
  Rgb background{};
  Rgb surroundings_factor{1, 1, 1};  ///< of background and map
  float surroundings_scale = 0;      ///< 0: there is no map
  float rotation_rad = 0;
  gpu::Binding surroundings;      ///< white where there is no map
  bool has_soft_shadows = false;  ///< of some lamp: it has a disc
  gpu::Binding shadow_maps;       ///< of lamps that are drawn by direct_light.h
  gpu::Binding shadow_depth;      ///< of the same picture
};

/// The triangles of a mesh in the order in which a DeviceScene has them: material by material.
std::vector<uint32_t> triangles_by_material(const scene::Mesh& mesh);

struct DeviceSceneParams {
  bool light_changes = false;  ///< put_light() will be called
  /// Per mesh and vertex, its place in the lightmap; empty: uv1 is.
  std::span<const std::vector<Vec2>> light_uv{};
  uint32_t shadow_side = 1;  ///< of the square picture of all shadow maps [pixels]
};

/// Side of the picture of shadow maps where lamps are drawn: 64 MB [pixels].
inline constexpr uint32_t kShadowSide = 4096;

/// E of all pages of the lightmap, and the page of each material.
struct PagesOfLight {
  std::span<const image::HalfImage> pages;
  std::span<const size_t> of_material;
};

/// Errors: no memory on the device, a picture larger than the device's may be.
Result<DeviceScene> put_on_device(gpu::Commands& commands, const scene::Scene& scene,
                                  const PagesOfLight& light, const DeviceSceneParams& params);
Result<DeviceScene> put_on_device(gpu::Commands& commands, const scene::Scene& scene,
                                  const pipeline::LightmapPages& lightmaps,
                                  const DeviceSceneParams& params = {});

/// Puts E into the first (0) or the second (1) pictures of all pages. They have the sizes of those
/// that the scene came with. Nothing may still draw the scene. Errors: no memory.
Status put_light(gpu::Commands& commands, std::span<const image::HalfImage> pages, uint32_t which,
                 DeviceScene& scene);

/// The factor of the light that an instance's surfaces emit, 1 to begin with. Nothing may still
/// draw the scene.
void set_emission_factor(uint32_t instance, Rgb factor, DeviceScene& scene);
/// Values for the next picture. Nothing may still draw the scene when they are changed.
on_device::LightNow& light_now(const DeviceScene& scene);

/// Another place of an instance. Nothing may still draw the scene.
void set_transform(uint32_t instance, const Mat34& world_from_object, DeviceScene& scene);
/// Another base colour of a material's surfaces, a factor of its texture. Nothing may still draw
/// the scene.
void set_base_color(size_t material, Rgb base_color, DeviceScene& scene);
/// Another emission of a material's surfaces [W/(sr m^2)], a factor of its texture. Nothing may
/// still draw the scene.
void set_emission(size_t material, Rgb emission, DeviceScene& scene);
/// Another share of metal of a material's surfaces, a factor of its texture. Nothing may still draw
/// the scene.
void set_metallic(size_t material, float metallic, DeviceScene& scene);
/// Other surroundings, whose map is as large as the one before. Nothing may still draw the scene.
/// Errors: no memory.
Status set_surroundings(gpu::Commands& commands, const scene::Environment& map, DeviceScene& scene);

}  // namespace luxel::view
