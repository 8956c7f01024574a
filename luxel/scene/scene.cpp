#include "luxel/scene/scene.h"

#include "luxel/base/check.h"
#include "luxel/image/color.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/off_surface.h"

namespace luxel::scene {
namespace {

const Mesh& mesh_of(const Scene& scene, uint32_t instance) {
  return scene.meshes[scene.instances[instance].mesh];
}

template <class T>
T attribute_at(const std::vector<T>& values, const std::array<uint32_t, 3>& corners,
               Barycentric at) {
  return interpolate(values[corners[0]], values[corners[1]], values[corners[2]], at);
}

/// Where all corners have one alpha, that is not rounded: a cutoff may be 1.
float alpha_between(const Mesh& mesh, const SurfacePoint& p) {
  if (mesh.alphas.empty()) return 1;
  const auto [a, b, c] = mesh.triangles[p.triangle];
  const float first = mesh.alphas[a];
  return first + (mesh.alphas[b] - first) * p.at.u + (mesh.alphas[c] - first) * p.at.v;
}

int wrapped(int i, int n, Wrap wrap) {
  if (i >= 0 && i < n) return i;  // most are: divisions take longer than all else
  if (wrap == Wrap::clamp) return std::clamp(i, 0, n - 1);
  const int period = wrap == Wrap::mirror ? 2 * n : n;
  const int j = ((i % period) + period) % period;
  return j < n ? j : period - 1 - j;
}

/// The share of 255 that a byte is, and its linear light in an sRGB texture.
struct ByteValues {
  std::array<float, 256> share, linear;
};
const ByteValues kOfByte = [] {
  ByteValues out{};
  for (size_t i = 0; i < out.share.size(); ++i) {
    out.share[i] = float(i) / 255.0f;
    out.linear[i] = image::linear_from_srgb(out.share[i]);
  }
  return out;
}();

std::array<float, 4> texel(const Texture& t, int x, int y, bool srgb) {
  const uint8_t* p = t.rgba.data() + 4 * (size_t(y) * size_t(t.width) + size_t(x));
  const std::array<float, 256>& of_colour = srgb ? kOfByte.linear : kOfByte.share;
  return {of_colour[p[0]], of_colour[p[1]], of_colour[p[2]], kOfByte.share[p[3]]};
}

/// Bilinear lookup; colours are filtered in linear light.
std::array<float, 4> sample(const Scene& scene, const TextureRef& ref, Vec2 uv, bool srgb) {
  const Texture& t = scene.textures[ref.texture];
  uv = transformed_uv(ref, uv);
  // A coordinate beyond float's integers would overflow the cast below; its phase is lost anyway.
  const auto bounded = [](float v) { return std::isfinite(v) ? std::clamp(v, -1e6f, 1e6f) : 0.0f; };
  const float x = bounded(uv.x) * float(t.width), y = bounded(uv.y) * float(t.height);
  if (ref.filter == Filter::nearest)
    return texel(t, wrapped(int(std::floor(x)), t.width, ref.wrap_u),
                 wrapped(int(std::floor(y)), t.height, ref.wrap_v), srgb);
  const int x0 = int(std::floor(x - 0.5f)), y0 = int(std::floor(y - 0.5f));
  const float fx = x - 0.5f - float(x0), fy = y - 0.5f - float(y0);
  const std::array column{wrapped(x0, t.width, ref.wrap_u), wrapped(x0 + 1, t.width, ref.wrap_u)},
      row{wrapped(y0, t.height, ref.wrap_v), wrapped(y0 + 1, t.height, ref.wrap_v)};
  std::array<float, 4> sum{};
  for (size_t j = 0; j < 2; ++j)
    for (size_t i = 0; i < 2; ++i) {
      const float w = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
      const auto c = texel(t, column[i], row[j], srgb);
      for (int k = 0; k < 4; ++k) sum[k] += w * c[k];
    }
  return sum;
}

}  // namespace

Vec2 transformed_uv(const TextureRef& ref, Vec2 uv) {
  if (ref.rotation == 0)
    return {uv.x * ref.scale.x + ref.offset.x, uv.y * ref.scale.y + ref.offset.y};
  const float s = std::sin(ref.rotation), c = std::cos(ref.rotation);
  const Vec2 q{uv.x * ref.scale.x, uv.y * ref.scale.y};
  return {c * q.x + s * q.y + ref.offset.x, -s * q.x + c * q.y + ref.offset.y};
}

std::array<float, 4> texture_at(const Scene& scene, const SurfacePoint& p, const TextureRef& ref,
                                bool srgb) {
  const Mesh& mesh = mesh_of(scene, p.instance);
  const std::vector<Vec2>& uv = ref.uv_set == 1 ? mesh.uv1 : mesh.uv0;
  if (ref.texture == kNone || uv.empty()) return {1, 1, 1, 1};
  return sample(scene, ref, attribute_at(uv, mesh.triangles[p.triangle], p.at), srgb);
}

Triangle3 world_triangle(const Scene& scene, uint32_t instance, uint32_t triangle) {
  const Mesh& mesh = mesh_of(scene, instance);
  const Mat34& m = scene.instances[instance].world_from_object;
  const auto& t = mesh.triangles[triangle];
  return {transform_point(m, mesh.positions[t[0]]), transform_point(m, mesh.positions[t[1]]),
          transform_point(m, mesh.positions[t[2]])};
}

Facet facet_of(const Scene& scene, uint32_t instance, uint32_t triangle) {
  const Triangle3 t = world_triangle(scene, instance, triangle);
  const Mat34& stands = scene.instances[instance].world_from_object;
  const Vec3 n = normalize(geometric_normal_area2(t));
  const Vec3 extent = max(max(t.a, t.b), t.c) - min(min(t.a, t.b), t.c);
  return {t, determinant(stands) < 0 ? -n : n, size_for_rounding(stands, extent, n)};
}

Vec3 front_normal(const Scene& scene, uint32_t instance, uint32_t triangle) {
  return facet_of(scene, instance, triangle).front;
}

Vec3 shading_normal(const Scene& scene, const SurfacePoint& p) {
  return shading_normal(scene, p, front_normal(scene, p.instance, p.triangle));
}

Vec3 shading_normal(const Scene& scene, const SurfacePoint& p, Vec3 front) {
  const Mesh& mesh = mesh_of(scene, p.instance);
  if (mesh.normals.empty()) return front;
  const Vec3 object = attribute_at(mesh.normals, mesh.triangles[p.triangle], p.at);
  const Vec3 n = normalize(transform_normal(scene.instances[p.instance].world_from_object, object));
  // Some files have normals that point inwards, or none at all that survive interpolation.
  const float side = dot(n, front);
  if (std::abs(side) < 1e-3f) return front;
  return side < 0 ? -n : n;
}

Vec3 world_position(const Scene& scene, const SurfacePoint& p) {
  const Triangle3 t = world_triangle(scene, p.instance, p.triangle);
  return interpolate(t.a, t.b, t.c, p.at);
}

const Material& material_at(const Scene& scene, const SurfacePoint& p) {
  return scene.materials[mesh_of(scene, p.instance).triangle_material[p.triangle]];
}

std::array<float, 4> base_color_at(const Scene& scene, const SurfacePoint& p) {
  const Material& material = material_at(scene, p);
  std::array<float, 4> c = texture_at(scene, p, material.base_color_texture, true);
  const Mesh& mesh = mesh_of(scene, p.instance);
  Rgb factor = material.base_color;
  if (!mesh.colors.empty())
    factor = factor * attribute_at(mesh.colors, mesh.triangles[p.triangle], p.at);
  return {c[0] * factor.x, c[1] * factor.y, c[2] * factor.z,
          c[3] * (material.alpha * alpha_between(mesh, p))};
}

namespace {

/// The share of a surface's light that is not left to metal.
float diffuse_share(const Scene& scene, const SurfacePoint& p, const Material& material) {
  const float metallic =
      material.metallic * texture_at(scene, p, material.metallic_texture, false)[2];
  return 1 - std::clamp(metallic, 0.0f, 1.0f);
}

/// The share of that light which is scattered through.
float scattered_share(const Scene& scene, const SurfacePoint& p, const Material& material) {
  if (!(material.diffuse_transmission > 0)) return 0;
  return std::clamp(material.diffuse_transmission *
                        texture_at(scene, p, material.diffuse_transmission_texture, false)[3],
                    0.0f, 1.0f);
}

}  // namespace

Rgb reflectance_at(const Scene& scene, const SurfacePoint& p) {
  const Material& material = material_at(scene, p);
  const auto c = base_color_at(scene, p);
  const float diffuse =
      diffuse_share(scene, p, material) * (1 - scattered_share(scene, p, material));
  return {std::clamp(c[0] * diffuse, 0.0f, kMaxReflectance),
          std::clamp(c[1] * diffuse, 0.0f, kMaxReflectance),
          std::clamp(c[2] * diffuse, 0.0f, kMaxReflectance)};
}

Rgb diffuse_transmittance_at(const Scene& scene, const SurfacePoint& p) {
  const Material& material = material_at(scene, p);
  const float scattered = scattered_share(scene, p, material);
  if (!(scattered > 0)) return {};
  const auto texture = texture_at(scene, p, material.diffuse_transmission_color_texture, true);
  const Rgb tau = material.diffuse_transmission_color * Rgb{texture[0], texture[1], texture[2]} *
                  (scattered * diffuse_share(scene, p, material));
  const Rgb most =
      Rgb{kMaxReflectance, kMaxReflectance, kMaxReflectance} - reflectance_at(scene, p);
  return min(max(tau, Rgb{}), most);
}

Rgb emission_at(const Scene& scene, const SurfacePoint& p) {
  const Material& material = material_at(scene, p);
  if (max_component(material.emission) <= 0) return {};
  const auto c = texture_at(scene, p, material.emission_texture, true);
  return material.emission * Rgb{c[0], c[1], c[2]};
}

bool is_solid_at(const Scene& scene, const SurfacePoint& p) {
  const Material& material = material_at(scene, p);
  if (material.alpha_mode != AlphaMode::mask) return true;
  return base_color_at(scene, p)[3] >= material.alpha_cutoff;
}

bool lets_light_through(const Material& material) {
  return material.alpha_mode != AlphaMode::opaque || material.transmission > 0;
}

bool tints_light(const Material& material) {
  return material.alpha_mode == AlphaMode::blend || material.transmission > 0;
}

bool reflects_from_behind(const Material& material) {
  return material.double_sided || tints_light(material) || material.diffuse_transmission > 0;
}

Passage passage_at(const Scene& scene, const SurfacePoint& p) {
  const Material& material = material_at(scene, p);
  if (!lets_light_through(material)) return {};
  const auto c = base_color_at(scene, p);
  const auto channel = [&](size_t k) { return std::clamp(c[k], 0.0f, 1.0f); };
  const Rgb color{channel(0), channel(1), channel(2)};
  if (material.alpha_mode == AlphaMode::mask && c[3] < material.alpha_cutoff) return {0, {1, 1, 1}};
  Passage out;
  if (material.alpha_mode == AlphaMode::blend) {
    out.coverage = channel(3);
    out.tint = Rgb{1, 1, 1} - (Rgb{1, 1, 1} - color) * out.coverage;
  }
  if (material.transmission > 0) {
    const float metallic =
        material.metallic * texture_at(scene, p, material.metallic_texture, false)[2];
    const float through = material.transmission * (1 - std::clamp(metallic, 0.0f, 1.0f)) *
                          texture_at(scene, p, material.transmission_texture, false)[0];
    // All light goes on where the blend does not cover; elsewhere the share `through` does,
    // coloured.
    const float open = 1 - out.coverage, glass = out.coverage * std::clamp(through, 0.0f, 1.0f);
    if (open + glass > 0) out.tint = (out.tint * open + color * glass) / (open + glass);
    out.coverage = 1 - open - glass;
  }
  return out;
}

Rgb surroundings_towards(const Scene& scene, Vec3 direction) {
  if (scene.environment.empty()) return scene.background;
  return scene.background + radiance_towards(scene.environment, direction);
}

Rgb smooth_surroundings_towards(const Scene& scene, Vec3 direction) {
  if (scene.environment.empty()) return scene.background;
  return scene.background + smooth_radiance_towards(scene.environment, direction);
}

std::vector<uint32_t> first_triangles(const Scene& scene) {
  std::vector<uint32_t> first{0};
  for (const Instance& instance : scene.instances)
    first.push_back(first.back() + uint32_t(scene.meshes[instance.mesh].triangles.size()));
  return first;
}

Box3 world_bounds(const Scene& scene) {
  Box3 box;
  for (const Instance& instance : scene.instances)
    for (const Vec3& p : scene.meshes[instance.mesh].positions)
      box.extend(transform_point(instance.world_from_object, p));
  return box;
}

}  // namespace luxel::scene
