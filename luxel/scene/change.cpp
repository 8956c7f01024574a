#include "luxel/scene/change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/scene/digest_parts.h"

namespace luxel::scene {
namespace {

/// An instance has another size where its axes' lengths or the cosines between them differ by more.
/// Far above the rounding of a rotation in float, far below what a texel's size would show.
constexpr double kSameSize = 1e-4;

/// So many changes are named, the others counted.
constexpr size_t kNamed = 4;

constexpr Rgb kAsItWas{1, 1, 1};

/// Digests of the pixels of a texture, with its size: red, green, blue, alpha.
using Channels = std::array<uint64_t, 4>;

Channels channels_of(const Texture& texture) {
  Channels out{};
  std::vector<uint8_t> values(texture.rgba.size() / 4);
  for (size_t channel = 0; channel < out.size(); ++channel) {
    for (size_t i = 0; i < values.size(); ++i) values[i] = texture.rgba[4 * i + channel];
    Digest d;
    d.add(texture.width), d.add(texture.height), add(d, values);
    out[channel] = d.value();
  }
  return out;
}

using Textures = std::vector<Channels>;
constexpr std::array<size_t, 3> kRgb{0, 1, 2};
constexpr std::array<size_t, 1> kRed{0}, kBlue{2}, kAlpha{3};

/// Adds some channels of a texture, as a material looks them up.
void add_texture(Digest& d, const Textures& textures, const TextureRef& ref,
                 std::span<const size_t> channels) {
  d.add(ref.texture != kNone);
  if (ref.texture == kNone) return;
  add_lookup(d, ref);
  for (const size_t channel : channels) d.add(textures[ref.texture][channel]);
}

constexpr uint64_t kDoubleSided = 1, kScatters = 2;

/// Digests of a material, by the functions that look members up: passage_at and
/// reflects_from_behind, reflectance_at and diffuse_transmittance_at, emission_at. All members are
/// named, so that a new one does not compile until somebody has thought of it.
SceneState::Material state_of(const Material& material, const Textures& textures) {
  // By names, so that a new member of Material stops the compiler here.
  const auto& [name, base_color, alpha, metallic, roughness, base_color_texture, metallic_texture,
               emission, emission_texture, normal_texture, normal_scale, alpha_mode, alpha_cutoff,
               transmission, transmission_texture, diffuse_transmission, diffuse_transmission_color,
               diffuse_transmission_texture, diffuse_transmission_color_texture, double_sided,
               unlit, specular, sharpness] = material;
  const bool scatters = diffuse_transmission > 0;
  // Several of the parts below share these.
  Digest metal, base;
  metal.add(metallic);
  if (metallic > 0) add_texture(metal, textures, metallic_texture, kBlue);
  add(base, base_color), add_texture(base, textures, base_color_texture, kRgb);

  // The shape decides which rays get through.
  Digest shape;
  shape.add(alpha_mode), shape.add(transmission > 0);
  if (alpha_mode != AlphaMode::opaque) {
    shape.add(alpha), add_texture(shape, textures, base_color_texture, kAlpha);
    if (alpha_mode == AlphaMode::mask) shape.add(alpha_cutoff);
  }
  if (transmission > 0) {
    shape.add(transmission), add_texture(shape, textures, transmission_texture, kRed);
    shape.add(metal.value());
  }
  if (tints_light(material)) shape.add(base.value());

  // The colour reflects, and the emission shines.
  Digest colour, emitted;
  colour.add(scatters), colour.add(base.value()), colour.add(metal.value());
  if (scatters) {
    colour.add(diffuse_transmission), add(colour, diffuse_transmission_color);
    add_texture(colour, textures, diffuse_transmission_texture, kAlpha);
    add_texture(colour, textures, diffuse_transmission_color_texture, kRgb);
  }
  add_texture(emitted, textures, emission_texture, kRgb);
  const uint64_t sides = (double_sided ? kDoubleSided : 0) | (scatters ? kScatters : 0);
  return {name, (shape.value() & ~(kDoubleSided | kScatters)) | sides, colour.value(),
          emitted.value(), emission};
}

SceneState::Light state_of(const Scene& scene, const PunctualLight& light) {
  PunctualLight rest = light;
  rest.intensity = {}, rest.profile = kNone;
  Digest shape;
  shape.add(digest(rest)), shape.add(light.profile != kNone);
  if (light.profile != kNone) shape.add(digest(scene.profiles[light.profile]));
  return {light.name, shape.value(), light.intensity};
}

SceneState::Instance state_of(const Scene& scene, const Instance& instance) {
  const auto& [name, mesh, world_from_object, density, lightmapped] = instance;
  Box3 bounds;
  for (const auto& corners : scene.meshes[mesh].triangles)
    for (const uint32_t v : corners)
      bounds.extend(transform_point(world_from_object, scene.meshes[mesh].positions[v]));
  return {name, mesh, world_from_object, bounds, layout_density(instance)};
}

std::vector<uint32_t> materials_of(const Mesh& mesh) {
  std::vector<uint32_t> out = mesh.triangle_material;
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// "3 lights there, 4 here"; empty where they are as many.
std::string other_number(size_t before, size_t now, std::string_view one, std::string_view many) {
  if (before == now) return {};
  return fmt::format("{} {} there, {} here", before, before == 1 ? one : many, now);
}

/// The lengths of its axes and the angles between them: what a rotation leaves alone.
bool same_size(const Mat34& a, const Mat34& b) {
  const auto axis_dot = [](const Mat34& m, int i, int j) {
    double sum = 0;
    for (const auto& row : m.row) sum += double(row[size_t(i)]) * double(row[size_t(j)]);
    return sum;
  };
  for (int i = 0; i < 3; ++i) {
    const double x = std::sqrt(axis_dot(a, i, i)), y = std::sqrt(axis_dot(b, i, i));
    if (std::abs(x - y) > kSameSize * std::max(x, y)) return false;
    for (int j = 0; j < i; ++j) {
      const double most = kSameSize * x * std::sqrt(axis_dot(a, j, j));
      if (std::abs(axis_dot(a, i, j) - axis_dot(b, i, j)) > most) return false;
    }
  }
  return true;
}

std::string beyond_instance(const SceneState::Instance& before, const SceneState::Instance& now,
                            size_t index) {
  const std::string name = called("instance", now.name, index);
  if (before.mesh != now.mesh) return name + " has another mesh";
  if (before.density != now.density) return name + " has another density of texels";
  if (!same_size(before.world_from_object, now.world_from_object))
    return name + " has another size";
  if ((determinant(before.world_from_object) < 0) != (determinant(now.world_from_object) < 0))
    return name + " is mirrored";
  return {};
}

std::string beyond_material(const SceneState::Material& before, const SceneState::Material& now,
                            size_t index) {
  const uint64_t flipped = before.shape ^ now.shape;
  const std::string name = called("material", now.name, index);
  if (flipped & kDoubleSided)
    return name + (now.shape & kDoubleSided ? " is double-sided now" : " is one-sided now");
  if (flipped & kScatters)
    return name + (now.shape & kScatters ? " scatters light through now"
                                         : " no longer scatters light through");
  return {};
}

std::string beyond_following(const SceneState& before, const SceneState& now) {
  for (const std::string& text :
       {other_number(before.meshes.size(), now.meshes.size(), "mesh", "meshes"),
        other_number(before.instances.size(), now.instances.size(), "instance", "instances"),
        other_number(before.materials.size(), now.materials.size(), "material", "materials"),
        other_number(before.lights.size(), now.lights.size(), "light", "lights")})
    if (!text.empty()) return text;
  for (size_t i = 0; i < now.meshes.size(); ++i)
    if (before.meshes[i] != now.meshes[i])
      return called("mesh", now.mesh_names[i], i) + " has changed";
  for (size_t i = 0; i < now.instances.size(); ++i)
    if (auto text = beyond_instance(before.instances[i], now.instances[i], i); !text.empty())
      return text;
  for (size_t i = 0; i < now.materials.size(); ++i)
    if (auto text = beyond_material(before.materials[i], now.materials[i], i); !text.empty())
      return text;
  return {};
}

/// The factor on light, per channel. Nothing where a channel was dark and is not, or where the
/// light is spread otherwise than before. Black that stays black has not changed, whatever its
/// shape.
std::optional<Rgb> scale_of(Rgb before, Rgb now, bool same_shape) {
  if (before == Rgb{} && now == Rgb{}) return kAsItWas;
  if (!same_shape) return std::nullopt;
  const auto factor = [](float from, float to) { return from == to ? 1.0f : to / from; };
  const Rgb scale{factor(before.x, now.x), factor(before.y, now.y), factor(before.z, now.z)};
  // A channel that was 0 is divided by: infinite.
  return is_finite(scale) ? std::optional(scale) : std::nullopt;
}

/// Boxes of the instance where it moved or a material of it has another shape.
void add_boxes(const SceneState& before, const SceneState& now, size_t instance, bool moved,
               SceneChange& change) {
  const auto is_reshaped = [&](uint32_t material) {
    return std::binary_search(change.reshaped.begin(), change.reshaped.end(), material);
  };
  const Box3 &was = before.instances[instance].bounds, &is = now.instances[instance].bounds;
  if (is.empty() || was.empty()) return;  // equal meshes: without triangles
  const auto& materials = now.mesh_materials[now.instances[instance].mesh];
  if (moved) change.boxes.push_back(was);
  if (moved || std::any_of(materials.begin(), materials.end(), is_reshaped))
    change.boxes.push_back(is);
}

std::string scaled(const std::string& name, const std::optional<Rgb>& scale) {
  return name + (scale ? " has another intensity" : " shines otherwise");
}

std::vector<std::string> sentences(const SceneState& now, const SceneChange& change) {
  std::vector<std::string> out;
  const auto material = [&](size_t i) { return called("material", now.materials[i].name, i); };
  for (const uint32_t i : change.moved)
    out.push_back(called("instance", now.instances[i].name, i) + " moved");
  for (const uint32_t i : change.reshaped)
    out.push_back(material(i) + " transmits light differently");
  for (const uint32_t i : change.recoloured) out.push_back(material(i) + " has another colour");
  for (size_t i = 0; i < change.light_scale.size(); ++i)
    if (change.light_scale[i] != kAsItWas)
      out.push_back(scaled(called("light", now.lights[i].name, i), change.light_scale[i]));
  for (size_t i = 0; i < change.emission_scale.size(); ++i)
    if (change.emission_scale[i] != kAsItWas)
      out.push_back(scaled(material(i), change.emission_scale[i]));
  if (change.surroundings) out.push_back("the surroundings have changed");
  return out;
}

}  // namespace

SceneState state_of(const Scene& scene) {
  SceneState out;
  Textures textures;
  for (const Texture& texture : scene.textures) textures.push_back(channels_of(texture));
  for (const Mesh& mesh : scene.meshes) {
    out.meshes.push_back(digest(mesh));
    out.mesh_names.push_back(mesh.name);
    out.mesh_materials.push_back(materials_of(mesh));
  }
  for (const Instance& instance : scene.instances)
    out.instances.push_back(state_of(scene, instance));
  for (const Material& material : scene.materials)
    out.materials.push_back(state_of(material, textures));
  for (const PunctualLight& light : scene.lights) out.lights.push_back(state_of(scene, light));
  Digest around;
  add(around, scene.background);
  if (!scene.environment.empty()) around.add(digest(scene.environment));
  out.surroundings = around.value();
  return out;
}

bool SceneChange::any() const {
  const auto changed = [](const std::optional<Rgb>& scale) { return scale != kAsItWas; };
  return !beyond.empty() || !moved.empty() || !boxes.empty() || !recoloured.empty() ||
         std::any_of(light_scale.begin(), light_scale.end(), changed) ||
         std::any_of(emission_scale.begin(), emission_scale.end(), changed) || surroundings ||
         !reshaped.empty();
}

SceneChange change_between(const SceneState& before, const SceneState& now) {
  LUXEL_CHECK(now.mesh_materials.size() == now.meshes.size());
  SceneChange out;
  out.beyond = beyond_following(before, now);
  if (!out.beyond.empty()) return out;
  for (uint32_t i = 0; i < now.materials.size(); ++i) {
    const SceneState::Material &was = before.materials[i], &is = now.materials[i];
    if (was.shape != is.shape) out.reshaped.push_back(i);
    if (was.colour != is.colour) out.recoloured.push_back(i);
    const bool same = was.shape == is.shape && was.emission_shape == is.emission_shape;
    out.emission_scale.push_back(scale_of(was.emission, is.emission, same));
  }
  for (size_t i = 0; i < now.lights.size(); ++i)
    out.light_scale.push_back(scale_of(before.lights[i].intensity, now.lights[i].intensity,
                                       before.lights[i].shape == now.lights[i].shape));
  for (uint32_t i = 0; i < now.instances.size(); ++i) {
    const bool moved = before.instances[i].world_from_object != now.instances[i].world_from_object;
    if (moved) out.moved.push_back(i);
    add_boxes(before, now, i, moved, out);
  }
  out.surroundings = before.surroundings != now.surroundings;
  return out;
}

std::string in_words(const SceneState& now, const SceneChange& change) {
  if (!change.beyond.empty()) return change.beyond;
  const std::vector<std::string> all = sentences(now, change);
  std::string out;
  for (size_t i = 0; i < std::min(kNamed, all.size()); ++i) out += (i ? ", " : "") + all[i];
  if (all.size() > kNamed) out += fmt::format(" and {} more", all.size() - kNamed);
  return out;
}

}  // namespace luxel::scene
