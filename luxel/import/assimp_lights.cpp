// Lights and cameras of the files that Assimp reads.
#include <assimp/scene.h>

#include <cmath>

#include "luxel/import/assimp_parts.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::import {
namespace {

NodePlace place_of(const NodePlaces& places, const aiString& name) {
  const auto found = places.find(name.C_Str());
  return found == places.end() ? NodePlace{} : found->second;
}

/// COLLADA's unit is in the root node's transform.
float unit_m(const aiScene& in) {
  return length(transform_vector(mat34_of(in.mRootNode->mTransformation), {1, 0, 0}));
}

void set_lens(const ColladaLens& lens, float unit, scene::Camera& camera) {
  camera.aspect = lens.aspect;
  if (lens.fov_y_rad > 0) camera.fov_y_rad = lens.fov_y_rad;
  camera.orthographic_height_m = lens.orthographic_height * unit;
}

/// Assimp hands no orthographic lens over from the formats that come here: those of FBX files look
/// like perspective ones.
void set_lens(const aiCamera& from, scene::Camera& camera) {
  camera.aspect = from.mAspect;
  const float aspect = from.mAspect > 0 ? from.mAspect : 1.0f;
  camera.fov_y_rad = 2 * std::atan(std::tan(0.5f * from.mHorizontalFOV) / aspect);
}

/// Nothing for Assimp's other kinds, ambient and area lights.
std::optional<scene::LightKind> kind_of(aiLightSourceType type) {
  if (type == aiLightSource_POINT) return scene::LightKind::point;
  if (type == aiLightSource_SPOT) return scene::LightKind::spot;
  if (type == aiLightSource_DIRECTIONAL) return scene::LightKind::directional;
  return std::nullopt;
}

}  // namespace

void add_assimp_lights(const aiScene& in, const SourceFile& source, const NodePlaces& places,
                       Imported& out, ExactPlaces& exact) {
  for (unsigned i = 0; i < in.mNumLights; ++i) {
    const aiLight& from = *in.mLights[i];
    const std::optional<scene::LightKind> kind = kind_of(from.mType);
    if (!kind) {
      out.warnings.push_back(
          fmt::format("light '{}' is neither point, spot nor directional and is "
                      "skipped",
                      from.mName.C_Str()));
      continue;
    }
    const auto [world, exact_world] = place_of(places, from.mName);
    scene::PunctualLight light;
    light.name = from.mName.C_Str();
    light.kind = *kind;
    light.intensity = {from.mColorDiffuse.r, from.mColorDiffuse.g, from.mColorDiffuse.b};
    light.position = transform_point(world, vec3_of(from.mPosition));
    light.direction = normalize(transform_vector(world, vec3_of(from.mDirection)));
    // Assimp's cone angles go from side to side, ours from the axis.
    light.inner_cone_rad = 0.5f * from.mAngleInnerCone;
    light.outer_cone_rad = 0.5f * from.mAngleOuterCone;
    // COLLADA states where the light ends; Assimp takes that for the inner cone and makes an outer
    // one up.
    if (source.extension == ".dae") light.outer_cone_rad = light.inner_cone_rad;
    out.scene.lights.push_back(light);
    exact.lights.push_back(transform_point(exact_world, to_double(vec3_of(from.mPosition))));
  }
}

void add_assimp_cameras(const aiScene& in, const SourceFile& source, const NodePlaces& places,
                        scene::Scene& out, ExactPlaces& exact) {
  std::vector<ColladaLens> lenses;
  if (source.extension == ".dae") lenses = read_collada_lenses(source);
  for (unsigned i = 0; i < in.mNumCameras; ++i) {
    const aiCamera& from = *in.mCameras[i];
    const auto [world, exact_world] = place_of(places, from.mName);
    const Vec3 forward = normalize(transform_vector(world, vec3_of(from.mLookAt)));
    const Vec3 right = normalize(cross(forward, transform_vector(world, vec3_of(from.mUp))));
    scene::Camera camera;
    camera.name = from.mName.C_Str();
    camera.world_from_camera = from_columns(right, cross(right, forward), -forward,
                                            transform_point(world, vec3_of(from.mPosition)));
    if (source.extension == ".dae")
      set_lens(lenses.size() == in.mNumCameras ? lenses[i] : ColladaLens{}, unit_m(in), camera);
    else
      set_lens(from, camera);
    out.cameras.push_back(camera);
    exact.cameras.push_back(transform_point(exact_world, to_double(vec3_of(from.mPosition))));
  }
}

}  // namespace luxel::import
