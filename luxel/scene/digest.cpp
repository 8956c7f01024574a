#include "luxel/scene/digest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "luxel/scene/digest_parts.h"

namespace luxel::scene {

// Every function below names all members of its struct, so that a new one cannot be forgotten: the
// list would be too short to compile.

uint64_t digest(const Mesh& m) {
  const auto& [name, positions, normals, uv0, uv1, colors, alphas, triangles, material,
               other_side] = m;
  Digest d;
  add(d, positions), add(d, normals), add(d, uv0), add(d, uv1), add(d, colors), add(d, alphas);
  add(d, triangles), add(d, material), add(d, other_side);
  return d.value();
}

void add_lookup(Digest& d, const TextureRef& ref) {
  const auto& [texture, uv_set, wrap_u, wrap_v, filter, offset, scale, rotation] = ref;
  d.add(uv_set), d.add(wrap_u), d.add(wrap_v), d.add(filter);
  for (const float x : {offset.x, offset.y, scale.x, scale.y, rotation}) d.add(x);
}

uint64_t digest(const PunctualLight& l) {
  const auto& [name, kind, intensity, position, direction, range_m, inner_cone_rad, outer_cone_rad,
               angular_radius_rad, profile, side] = l;
  Digest d;
  d.add(kind), d.add(profile);
  for (const Vec3& v : {intensity, position, direction, side}) add(d, v);
  for (const float x : {range_m, inner_cone_rad, outer_cone_rad, angular_radius_rad}) d.add(x);
  return d.value();
}

uint64_t digest(const LightProfile& p) {
  const auto& [name, angles, vertical_rad, horizontal_rad, candela] = p;
  Digest d;
  d.add(angles), add(d, vertical_rad), add(d, horizontal_rad), add(d, candela);
  return d.value();
}

uint64_t digest(const Environment& e) {
  const auto& [width, height, radiance, rotation_rad] = e;
  Digest d;
  d.add(width), d.add(height), add(d, radiance), d.add(rotation_rad);
  return d.value();
}

std::string called(std::string_view kind, std::string_view name, size_t index) {
  if (name.empty()) return fmt::format("{} number {}", kind, index + 1);
  return fmt::format("{} '{}'", kind, name);
}

namespace {

uint64_t digest(const Instance& i) {
  const auto& [name, mesh, world_from_object, texel_density, lightmapped] = i;
  Digest d;
  d.add(mesh), add(d, world_from_object), d.add(texel_density), d.add(lightmapped);
  return d.value();
}

void add_texture(Digest& d, const TextureRef& ref) {
  d.add(ref.texture);
  add_lookup(d, ref);
}

uint64_t digest(const Material& m) {
  const auto& [name, base_color, alpha, metallic, roughness, base_color_texture, metallic_texture,
               emission, emission_texture, normal_texture, normal_scale, alpha_mode, alpha_cutoff,
               transmission, transmission_texture, diffuse_transmission, diffuse_transmission_color,
               diffuse_transmission_texture, diffuse_transmission_color_texture, double_sided,
               unlit, specular, sharpness] = m;
  Digest d;
  add(d, base_color), add(d, emission), add(d, diffuse_transmission_color), add(d, specular);
  for (const float x : {alpha, metallic, roughness, normal_scale, alpha_cutoff, transmission,
                        diffuse_transmission, sharpness})
    d.add(x);
  for (const TextureRef* texture :
       {&base_color_texture, &metallic_texture, &emission_texture, &normal_texture,
        &transmission_texture, &diffuse_transmission_texture, &diffuse_transmission_color_texture})
    add_texture(d, *texture);
  d.add(alpha_mode), d.add(double_sided), d.add(unlit);
  return d.value();
}

uint64_t digest(const Texture& t) {
  const auto& [name, width, height, rgba, encoded, mime_type] = t;
  Digest d;
  d.add(width), d.add(height), add(d, rgba);
  return d.value();
}

uint64_t digest(const Camera& c) {
  const auto& [name, world_from_camera, fov_y_rad, aspect, orthographic_height_m] = c;
  Digest d;
  add(d, world_from_camera);
  for (const float x : {fov_y_rad, aspect, orthographic_height_m}) d.add(x);
  return d.value();
}

template <class T>
void append(std::string_view kind, const std::vector<T>& things, std::vector<ItemDigest>& out) {
  for (const T& thing : things) out.push_back({std::string(kind), thing.name, digest(thing)});
}

/// Kinds with one item in a scene. Messages call it "the ...".
constexpr std::array<std::string_view, 2> kSingle{"background", "environment"};

std::vector<const ItemDigest*> of_kind(std::span<const ItemDigest> items, std::string_view kind) {
  std::vector<const ItemDigest*> out;
  for (const ItemDigest& item : items)
    if (item.kind == kind) out.push_back(&item);
  return out;
}

std::string name_of(const ItemDigest& item, size_t index) {
  if (std::find(kSingle.begin(), kSingle.end(), item.kind) != kSingle.end())
    return "the " + item.kind;
  return called(item.kind, item.name, index);
}

}  // namespace

std::vector<ItemDigest> digests_of(const Scene& scene) {
  const auto& [name, meshes, instances, materials, textures, lights, profiles, cameras, background,
               environment, ignored_origin] = scene;
  std::vector<ItemDigest> out;
  append("mesh", meshes, out);
  append("instance", instances, out);
  append("material", materials, out);
  append("texture", textures, out);
  append("light", lights, out);
  append("profile", profiles, out);
  append("camera", cameras, out);
  Digest radiance;
  add(radiance, background);
  out.push_back({"background", "", radiance.value()});
  out.push_back({"environment", "", digest(environment)});
  return out;
}

std::string difference(std::span<const ItemDigest> before, std::span<const ItemDigest> now) {
  std::vector<std::string_view> kinds;
  for (const auto& items : {before, now})
    for (const ItemDigest& item : items)
      if (std::find(kinds.begin(), kinds.end(), item.kind) == kinds.end())
        kinds.push_back(item.kind);
  for (const std::string_view kind : kinds) {
    const auto a = of_kind(before, kind), b = of_kind(now, kind);
    if (a.size() != b.size())
      return fmt::format("{} of kind {} there, {} here", a.size(), kind, b.size());
    for (size_t i = 0; i < a.size(); ++i)
      if (a[i]->digest != b[i]->digest) return name_of(*b[i], i) + " has changed";
  }
  return {};
}

}  // namespace luxel::scene
