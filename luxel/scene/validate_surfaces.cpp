// Triangles without area, normals without direction, surfaces that reflect more than they receive.
#include <algorithm>
#include <cfloat>

#include "luxel/base/vec_double.h"
#include "luxel/image/color.h"
#include "luxel/scene/validate_steps.h"

namespace luxel::scene {
namespace {

DVec3 difference(Vec3 a, Vec3 b) { return to_double(a) - to_double(b); }
double squared_length(DVec3 a) { return a.x * a.x + a.y * a.y + a.z * a.z; }

/// A triangle has no area when its height over the longest edge is not above the rounding unit of
/// its own coordinates: its corners may then just as well lie on a line. Computed in double, where
/// the differences of floats are exact, so the verdict is that of the stored numbers.
bool has_area(const Triangle3& t) {
  const DVec3 e0 = difference(t.b, t.a), e1 = difference(t.c, t.a), e2 = difference(t.c, t.b);
  const DVec3 n{e0.y * e1.z - e0.z * e1.y, e0.z * e1.x - e0.x * e1.z, e0.x * e1.y - e0.y * e1.x};
  const double longest2 = std::max({squared_length(e0), squared_length(e1), squared_length(e2)});
  double magnitude = 0;
  for (const Vec3& p : {t.a, t.b, t.c})
    for (int axis = 0; axis < 3; ++axis) magnitude = std::max(magnitude, double(std::abs(p[axis])));
  const double rounding = magnitude * double(FLT_EPSILON) / 2;
  return squared_length(n) > longest2 * rounding * rounding;
}

/// Whether the single-precision cross product that everyone uses gives a direction, also on threads
/// that flush denormals to zero.
bool has_direction(const Triangle3& t) {
  const Vec3 n = geometric_normal_area2(t);
  const float length2 = dot(n, n);
  return length2 >= FLT_MIN && std::isfinite(length2);
}

std::vector<std::vector<uint32_t>> instances_by_mesh(const Scene& scene) {
  std::vector<std::vector<uint32_t>> users(scene.meshes.size());
  for (uint32_t i = 0; i < scene.instances.size(); ++i) users[scene.instances[i].mesh].push_back(i);
  return users;
}

/// The repair of a vertex without a usable normal: the sum of the area vectors of its triangles.
/// In a flat patch this is the flat normal.
std::vector<Vec3> area_weighted_normals(const Mesh& mesh) {
  std::vector<Vec3> sums(mesh.positions.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 n =
        geometric_normal_area2({mesh.positions[a], mesh.positions[b], mesh.positions[c]});
    for (const uint32_t corner : {a, b, c}) sums[corner] += n;
  }
  return sums;
}

/// normalize() by way of the largest component: (1e-30, 0, 0) has a direction, but its squared
/// length underflows.
Vec3 robust_normalize(Vec3 n) {
  const float largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  if (!luxel::is_finite(n) || largest < FLT_MIN) return {};
  return normalize(n * (0.5f / largest) * 2.0f);
}

/// The largest factor by which vertex colours multiply each material where it is used; zero for a
/// material that no triangle has.
std::vector<Rgb> brightest_vertex_colors(const Scene& scene) {
  std::vector<Rgb> brightest(scene.materials.size());
  for (const Mesh& mesh : scene.meshes)
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      Rgb& c = brightest[mesh.triangle_material[t]];
      if (mesh.colors.empty())
        c = max(c, Rgb{1, 1, 1});
      else
        for (const uint32_t corner : mesh.triangles[t]) c = max(c, mesh.colors[corner]);
    }
  return brightest;
}

/// The brightest value of each channel over a texture's texels, in linear light.
Rgb brightest_texel(const Texture& texture) {
  std::array<uint8_t, 3> most{};
  for (size_t i = 0; i + 3 < texture.rgba.size(); i += 4)
    for (size_t k = 0; k < 3; ++k) most[k] = std::max(most[k], texture.rgba[i + k]);
  const auto linear = [](uint8_t v) { return image::linear_from_srgb(float(v) / 255.0f); };
  return {linear(most[0]), linear(most[1]), linear(most[2])};
}

}  // namespace

void drop_singular_instances(Scene& scene, Report& report) {
  std::vector<std::string> dropped;
  std::vector<Instance> kept;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Mat34& m = scene.instances[i].world_from_object;
    // Relative to a cube of the columns' lengths, so that a small scale is no reason.
    const double volume =
        double(length(column(m, 0))) * double(length(column(m, 1))) * double(length(column(m, 2)));
    const DVec3 a{column(m, 0).x, column(m, 0).y, column(m, 0).z};
    const DVec3 b{column(m, 1).x, column(m, 1).y, column(m, 1).z};
    const DVec3 c{column(m, 2).x, column(m, 2).y, column(m, 2).z};
    const double det = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
                       a.z * (b.x * c.y - b.y * c.x);
    if (std::abs(det) > 1e-7 * volume)
      kept.push_back(std::move(scene.instances[i]));
    else
      dropped.push_back(label("instance", i, scene.instances[i].name));
  }
  scene.instances = std::move(kept);
  if (!dropped.empty())
    report.warn("{} instances are squashed flat by their transform and dropped: {}", dropped.size(),
                listed(dropped));
}

void drop_zero_area_triangles(Scene& scene, Report& report) {
  const std::vector<std::vector<uint32_t>> users = instances_by_mesh(scene);
  size_t dropped = 0;
  std::vector<std::string> names;
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    Mesh& mesh = scene.meshes[i];
    std::vector<uint8_t> keep(mesh.triangles.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      keep[t] = has_area({mesh.positions[a], mesh.positions[b], mesh.positions[c]});
      // One that vanishes in one place only (tiny scale, far translation) vanishes everywhere: a
      // mesh is shared, and solvers must not meet it.
      for (const uint32_t instance : users[i])
        keep[t] = keep[t] && has_direction(world_triangle(scene, instance, t));
    }
    size_t n = 0;
    for (size_t t = 0; t < keep.size(); ++t)
      if (keep[t]) {
        mesh.triangles[n] = mesh.triangles[t];
        mesh.triangle_material[n++] = mesh.triangle_material[t];
      }
    if (n == keep.size()) continue;
    dropped += keep.size() - n;
    names.push_back(label("mesh", i, mesh.name));
    mesh.triangles.resize(n);
    mesh.triangle_material.resize(n);
  }
  if (dropped) report.warn("{} zero-area triangles dropped from {}", dropped, listed(names));
}

void repair_normals(Scene& scene, Report& report) {
  size_t replaced = 0;
  for (Mesh& mesh : scene.meshes) {
    std::vector<size_t> bad;
    for (size_t v = 0; v < mesh.normals.size(); ++v) {
      Vec3& n = mesh.normals[v];
      // A normal that is a unit vector to float precision keeps its bits.
      if (std::abs(dot(n, n) - 1.0f) < 1e-5f) continue;
      n = robust_normalize(n);
      if (n == Vec3{}) bad.push_back(v);
    }
    if (bad.empty()) continue;
    const std::vector<Vec3> flat = area_weighted_normals(mesh);
    for (const size_t v : bad) {
      const Vec3 n = robust_normalize(flat[v]);
      mesh.normals[v] = n == Vec3{} ? Vec3{0, 1, 0} : n;  // a vertex of no triangle
    }
    replaced += bad.size();
  }
  if (replaced)
    report.warn("{} vertex normals are zero or not finite; replaced by those of the triangles",
                replaced);
}

void clamp_reflectance(Scene& scene, Report& report) {
  const std::vector<Rgb> brightest_color = brightest_vertex_colors(scene);
  std::vector<std::string> clamped;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    Material& m = scene.materials[i];
    // A metallic texture can only be judged per texel; without one the factor is exact.
    const float diffuse = m.metallic_texture.texture == kNone ? 1 - m.metallic : 1.0f;
    Rgb brightest = brightest_color[i];
    if (m.base_color_texture.texture != kNone)
      brightest = brightest * brightest_texel(scene.textures[m.base_color_texture.texture]);
    const Rgb reflectance = m.base_color * brightest * diffuse;
    if (max_component(reflectance) <= kMaxReflectance) continue;
    clamped.push_back(label("material", i, m.name));
    // Where textures or vertex colours have a say, the dark places must keep their value:
    // reflectance_at() clamps the product there.
    if (brightest != Rgb{1, 1, 1} || m.base_color_texture.texture != kNone ||
        m.metallic_texture.texture != kNone)
      continue;
    const float most = kMaxReflectance / diffuse;
    m.base_color = min(m.base_color, Rgb{most, most, most});
  }
  if (!clamped.empty())
    report.warn("reflectance over {} clamped: {}", kMaxReflectance, listed(clamped));
}

}  // namespace luxel::scene
