// Triangles without area, normals without direction, surfaces that reflect more than they receive.
#include <algorithm>
#include <array>
#include <cfloat>
#include <span>

#include "luxel/base/vec_double.h"
#include "luxel/image/color.h"
#include "luxel/scene/held_range.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/validate_steps.h"

namespace luxel::scene {
namespace {

DVec3 difference(Vec3 a, Vec3 b) { return to_double(a) - to_double(b); }
double squared_length(DVec3 a) { return dot(a, a); }

double largest_coordinate(Vec3 p) {
  return double(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
}

DVec3 absolute(DVec3 a) { return {std::abs(a.x), std::abs(a.y), std::abs(a.z)}; }

/// The most that n = e0 x e1 may change, per axis, when a corner at p is rounded and e is the edge
/// across from it: the product of the edge and of half an ulp of each coordinate, without signs.
DVec3 rounding_of_normal(Vec3 p, DVec3 e) {
  const DVec3 d = absolute(to_double(p)) * (double(FLT_EPSILON) / 2);
  e = absolute(e);
  return {e.y * d.z + e.z * d.y, e.z * d.x + e.x * d.z, e.x * d.y + e.y * d.x};
}

/// A triangle has no area when the rounding of its corners alone could have made the area that it
/// has: its corners may then just as well lie on a line. It has one when its height over the
/// longest edge is above the rounding unit of its largest coordinate. What has one far corner is
/// not so high, for that corner is rounded by metres; there the rounding of each corner counts,
/// which matters little where it goes along the edge across. Computed in double, where the
/// differences of floats are exact, so the verdict is that of the stored numbers.
bool has_area(const Triangle3& t) {
  const DVec3 e0 = difference(t.b, t.a), e1 = difference(t.c, t.a), e2 = difference(t.c, t.b);
  const double n2 = squared_length(cross(e0, e1));
  const double longest2 = std::max({squared_length(e0), squared_length(e1), squared_length(e2)});
  const double rounding =
      std::max({largest_coordinate(t.a), largest_coordinate(t.b), largest_coordinate(t.c)}) *
      (double(FLT_EPSILON) / 2);
  if (n2 > longest2 * rounding * rounding) return true;
  const DVec3 by_corners =
      rounding_of_normal(t.a, e2) + rounding_of_normal(t.b, e1) + rounding_of_normal(t.c, e0);
  return n2 > squared_length(by_corners);
}

/// A verdict on a triangle: flat has no area in its mesh, too_small one that single precision does
/// not hold, blurred one that the rounding of its place in the world takes away.
enum class Fate : uint8_t { kept, flat, too_small, blurred };

/// The verdict on a triangle in the world, where solvers and rays take its normal in single
/// precision; it has an area in its mesh.
Fate fate_in_world(const Triangle3& t) {
  if (has_unit_vector(geometric_normal_area2(t))) return Fate::kept;
  return has_area(t) ? Fate::too_small : Fate::blurred;
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

Scales scales_of(const Mat34& m) {
  const DVec3 a = to_double(column(m, 0)), b = to_double(column(m, 1)), c = to_double(column(m, 2));
  return {length(a), length(b), length(c), dot(a, cross(b, c))};
}

void drop_singular_instances(Scene& scene, Report& report) {
  std::vector<std::string> flat, tiny;
  std::vector<Instance> kept;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Scales s = scales_of(scene.instances[i].world_from_object);
    // Relative to a cube of the columns' lengths, so that a small scale is no reason.
    if (!(std::abs(s.volume) > 1e-7 * s.x * s.y * s.z))
      flat.push_back(label("instance", i, scene.instances[i].name));
    else if (s.smallest_product() < double(kLeastDoubleArea_m2))
      tiny.push_back(label("instance", i, scene.instances[i].name));
    else
      kept.push_back(std::move(scene.instances[i]));
  }
  scene.instances = std::move(kept);
  if (!flat.empty())
    report.warn_of_loss(
        fmt::format("{} instances are squashed flat by their transform and dropped: {}",
                    flat.size(), listed(flat)));
  if (!tiny.empty())
    report.warn_of_loss(
        fmt::format("{} instances are scaled down to nothing (two of their scales have a product "
                    "below {:.2g}) and dropped: {}",
                    tiny.size(), kLeastDoubleArea_m2, listed(tiny)));
}

namespace {

/// Per mesh, what has happened to its triangles.
struct Dropped {
  size_t count = 0;
  std::vector<std::string> meshes;
  std::string example;  ///< the instance that was the reason

  void add(size_t n, const std::string& mesh) {
    if (n == 0) return;
    count += n;
    meshes.push_back(mesh);
  }
};

/// The fate of a mesh's triangle, and the instance that decides it.
struct Verdict {
  Fate fate = Fate::kept;
  uint32_t instance = kNone;
};

Verdict verdict_on(const Scene& scene, const Mesh& mesh, std::span<const uint32_t> users,
                   uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  if (!has_area({mesh.positions[a], mesh.positions[b], mesh.positions[c]})) return {Fate::flat};
  // One that vanishes in one place only (tiny scale, far translation) vanishes everywhere: a mesh
  // is shared, and solvers must not meet it.
  for (const uint32_t instance : users)
    if (const Fate fate = fate_in_world(world_triangle(scene, instance, triangle));
        fate != Fate::kept)
      return {fate, instance};
  return {};
}

void warn_of_dropped(const Dropped& flat, const Dropped& tiny, const Dropped& blurred,
                     Report& report) {
  if (flat.count)
    report.warn_of_loss(
        fmt::format("{} zero-area triangles dropped from {}", flat.count, listed(flat.meshes)));
  if (tiny.count)
    report.warn_of_loss(fmt::format(
        "{} triangles are too small for single precision (twice their area is below {:.2g} m^2) "
        "and dropped from {}; scale the scene up",
        tiny.count, kLeastDoubleArea_m2, listed(tiny.meshes)));
  if (blurred.count)
    report.warn_of_loss(fmt::format(
        "{} triangles are smaller than the steps of single precision where {} puts them, and "
        "dropped from {}; move it nearer to the origin",
        blurred.count, blurred.example, listed(blurred.meshes)));
}

}  // namespace

void drop_zero_area_triangles(Scene& scene, Report& report) {
  const std::vector<std::vector<uint32_t>> users = instances_by_mesh(scene);
  Dropped flat, tiny, blurred;
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    Mesh& mesh = scene.meshes[i];
    std::array<size_t, 4> with_fate{};
    size_t n = 0;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [fate, k] = verdict_on(scene, mesh, users[i], t);
      ++with_fate[size_t(fate)];
      if (fate == Fate::blurred && blurred.example.empty())
        blurred.example = label("instance", k, scene.instances[k].name);
      // Later verdicts look at later triangles only.
      if (fate != Fate::kept) continue;
      mesh.triangles[n] = mesh.triangles[t];
      mesh.triangle_material[n++] = mesh.triangle_material[t];
    }
    const std::string name = label("mesh", i, mesh.name);
    flat.add(with_fate[size_t(Fate::flat)], name);
    tiny.add(with_fate[size_t(Fate::too_small)], name);
    blurred.add(with_fate[size_t(Fate::blurred)], name);
    mesh.triangles.resize(n);
    mesh.triangle_material.resize(n);
  }
  warn_of_dropped(flat, tiny, blurred, report);
}

void warn_of_steps(const Scene& scene, Report& report) {
  size_t all = 0, small = 0;
  float most_m = 0;  // the largest coordinate that such a triangle is misplaced by a part of
  uint32_t mesh = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t, ++all) {
      const Facet facet = facet_of(scene, i, t);
      const auto& [a, b, c] = facet.corners;
      const Vec3 centre = (a + b + c) * (1.0f / 3);
      if (std::sqrt(area_m2(facet.corners)) >= rounding_m(centre, facet.size_m)) continue;
      ++small;
      const float reach_m = std::max(max_component(max(centre, -centre)), facet.size_m);
      if (reach_m > most_m) most_m = reach_m, mesh = scene.instances[i].mesh;
    }
  if (2 * small <= all) return;
  report.warn(
      "{} of {} triangles are smaller than the distance at which rays start off them, {:.3g} m for "
      "{}, which has coordinates of {:.3g} m: light will miss them; move it nearer to the origin",
      small, all, rounding_m({}, most_m), label("mesh", mesh, scene.meshes[mesh].name), most_m);
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

void warn_of_transparent(const Scene& scene, Report& report) {
  std::vector<size_t> triangles(scene.materials.size());
  for (const Instance& instance : scene.instances)
    for (const uint32_t m : scene.meshes[instance.mesh].triangle_material) ++triangles[m];
  std::vector<std::string> names;
  size_t count = 0;
  for (size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    const bool cut = material.alpha_mode == AlphaMode::mask && material.alpha_cutoff > 0;
    if (triangles[m] == 0 || material.alpha > 0) continue;
    if (!cut && material.alpha_mode != AlphaMode::blend) continue;
    names.push_back("'" + material.name + "'"), count += triangles[m];
  }
  if (!names.empty())
    report.warn(
        "{} triangles of {} are fully transparent (alpha 0, d 0 or Tr 1 in .mtl), so they are "
        "neither seen nor lit",
        count, listed(names));
}

}  // namespace luxel::scene
