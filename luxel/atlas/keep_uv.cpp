#include "luxel/atlas/keep_uv.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "luxel/atlas/cover.h"
#include "luxel/scene/drawn_triangle.h"

namespace luxel::atlas {
namespace {

/// Names by which a user can find a drawn triangle.
std::string triangle_name(const scene::Scene& scene, const Atlas& atlas, uint32_t number) {
  const auto [instance, triangle] = scene::drawn_triangle(atlas.first_triangle, number);
  const scene::Instance& placed = scene.instances[instance];
  const std::string& mesh = scene.meshes[placed.mesh].name;
  return fmt::format("triangle {} of mesh '{}' (instance {} '{}')", triangle,
                     mesh.empty() ? fmt::format("{}", placed.mesh) : mesh, instance, placed.name);
}

Status check_range(const scene::Scene& scene) {
  constexpr float kRounding = 1e-5f;  // exporters round; a texel of the largest atlas is 6e-5
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) continue;
    if (mesh.uv1.empty())
      return fail(ErrorCode::bad_setting, "mesh '{}' has no TEXCOORD_1", mesh.name);
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const uint32_t v : mesh.triangles[t]) {
        const Vec2 uv = mesh.uv1[v];
        if (!(uv.x >= -kRounding && uv.x <= 1 + kRounding && uv.y >= -kRounding &&
              uv.y <= 1 + kRounding))
          return fail(ErrorCode::bad_input,
                      "triangle {} of mesh '{}' has TEXCOORD_1 ({}, {}) outside [0, 1]", t,
                      mesh.name, uv.x, uv.y);
      }
  }
  return {};
}

void add_corners(const scene::Scene& scene, Atlas& atlas) {
  const auto texels = [&](float u) { return std::clamp(u, 0.0f, 1.0f) * float(atlas.resolution); };
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& t : mesh.triangles) {
      std::array<Vec2, 3> c;
      for (int k = 0; k < 3; ++k) c[k] = {texels(mesh.uv1[t[k]].x), texels(mesh.uv1[t[k]].y)};
      atlas.corners.push_back(c);
    }
  }
}

/// Triangles belong to one chart when they share a place of the surface and of the atlas.
void number_charts(const scene::Scene& scene, Atlas& atlas) {
  const size_t count = atlas.corners.size();
  std::vector<uint32_t> parent(count);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](uint32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  struct Corner {
    std::array<float, 5> key;
    uint32_t triangle;
  };
  std::vector<Corner> corners;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    corners.clear();
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const uint32_t v : mesh.triangles[t]) {
        const Vec3 p = mesh.positions[v];
        corners.push_back(
            {{p.x, p.y, p.z, mesh.uv1[v].x, mesh.uv1[v].y}, atlas.first_triangle[i] + t});
      }
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
      return std::tie(a.key, a.triangle) < std::tie(b.key, b.triangle);
    });
    for (size_t k = 1; k < corners.size(); ++k)
      if (corners[k].key == corners[k - 1].key) {
        const uint32_t a = root(corners[k].triangle), b = root(corners[k - 1].triangle);
        parent[std::max(a, b)] = std::min(a, b);
      }
  }
  atlas.chart.assign(count, kNone);
  for (uint32_t t = 0; t < count; ++t) {
    const uint32_t r = root(t);  // never above t: numbers come in the order of first triangles
    if (r == t) atlas.chart[t] = atlas.chart_count++;
    atlas.chart[t] = atlas.chart[r];
  }
}

/// Per texel, the triangle that its centre lies strictly inside of. Errors: two of them.
Result<std::vector<uint32_t>> find_holders(const scene::Scene& scene, const Atlas& atlas,
                                           const Progress& progress) {
  const int n = atlas.resolution;
  std::vector<uint32_t> holder(size_t(n) * size_t(n), kNone);
  for (uint32_t t = 0; t < atlas.corners.size(); ++t) {
    if (t % 1024 == 0) LUXEL_TRY_STATUS(stopped(progress));
    const auto& c = atlas.corners[t];
    const UvTriangle triangle = uv_triangle({to_double(c[0]), to_double(c[1]), to_double(c[2])});
    const Span rows = touched_rows(triangle);
    for (int j = std::max(0, rows.begin); j < std::min(n, rows.end); ++j) {
      const Span span = centre_texels(triangle, j, CentreRule::strictly_inside);
      for (int i = std::max(0, span.begin); i < std::min(n, span.end); ++i) {
        uint32_t& other = holder[size_t(j) * size_t(n) + size_t(i)];
        if (other != kNone)
          return fail(ErrorCode::bad_input,
                      "TEXCOORD_1 overlaps at resolution {}: the centre of texel ({}, {}) lies in "
                      "{} and in {}",
                      n, i, j, triangle_name(scene, atlas, other), triangle_name(scene, atlas, t));
        other = t;
      }
    }
  }
  return holder;
}

Status check_instances(const scene::Scene& scene) {
  std::vector<uint32_t> user(scene.meshes.size(), kNone);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const uint32_t m = scene.instances[i].mesh;
    if (scene.meshes[m].triangles.empty()) continue;
    if (user[m] != kNone)
      return fail(ErrorCode::bad_input,
                  "instances {} '{}' and {} '{}' share mesh '{}' and so triangle 0 of both lies at "
                  "one place of TEXCOORD_1",
                  user[m], scene.instances[user[m]].name, i, scene.instances[i].name,
                  scene.meshes[m].name);
    user[m] = i;
  }
  return {};
}

/// Exporters leave slivers without a place of their own, which are less of a surface than this.
constexpr double kFewWithoutPlace = 0.01;

double area_of(const Atlas& atlas, uint32_t t) {
  const auto& c = atlas.corners[t];
  return 0.5 *
         std::abs(cross(to_double(c[1]) - to_double(c[0]), to_double(c[2]) - to_double(c[0])));
}

/// Areas that tell the scale of a texel.
struct Areas {
  std::vector<float> world;  ///< per drawn triangle [m^2]
  double m2_per_texel = 0;   ///< mean over all triangles
};
Areas areas_of(const scene::Scene& scene, const Atlas& atlas) {
  Areas out;
  double world = 0, texels = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t) {
      out.world.push_back(
          scene::area_m2(scene::world_triangle(scene, i, t - atlas.first_triangle[i])));
      world += double(out.world.back()), texels += area_of(atlas, t);
    }
  if (texels > 0) out.m2_per_texel = world / texels;
  return out;
}

/// True where a triangle is a point or a line of the map, up to rounding.
bool is_collapsed(const Atlas& atlas, const Areas& areas, uint32_t t) {
  constexpr double kLine = 1e-7, kPoint = 1e-3;  // of a square; of what triangles have in the mean
  const auto& c = atlas.corners[t];
  double longest = 0;
  for (size_t k = 0; k < 3; ++k)
    longest = std::max(longest, length(to_double(c[(k + 1) % 3]) - to_double(c[k])));
  const double area = area_of(atlas, t);
  return area <= kLine * longest * longest ||
         area * areas.m2_per_texel < kPoint * double(areas.world[t]);
}

/// The first instance of which more than a few triangles have no area in the map; empty: none.
std::string what_is_collapsed(const scene::Scene& scene, const Atlas& atlas, const Areas& areas) {
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    double whole = 0, lost = 0;
    size_t count = 0;
    for (uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t) {
      const auto area = double(areas.world[t]);
      whole += area;
      if (area > 0 && is_collapsed(atlas, areas, t)) lost += area, ++count;
    }
    if (lost > kFewWithoutPlace * whole)
      return fmt::format(
          "{} triangles of '{}' (mesh '{}') lie on one point or line each of TEXCOORD_1, so light "
          "cannot differ on them",
          count, scene.instances[i].name, scene.meshes[scene.instances[i].mesh].name);
  }
  return {};
}

Box3 world_box(const scene::Scene& scene, const Atlas& atlas, uint32_t number) {
  const auto [instance, triangle] = scene::drawn_triangle(atlas.first_triangle, number);
  Box3 box;
  const scene::Triangle3 corners = scene::world_triangle(scene, instance, triangle);
  for (const Vec3 p : {corners.a, corners.b, corners.c}) box.extend(p);
  return box;
}

float distance(const Box3& a, const Box3& b) {
  return length(max(max(a.lower - b.upper, b.lower - a.upper), Vec3{}));
}

/// Charts smaller than a texel hold no texel centre. Whatever else lies in their texel gets their
/// light, which is only right for what lies about a texel away. Takes over `holder`.
std::string what_shares_texels(const scene::Scene& scene, const Atlas& atlas, const Areas& areas,
                               std::vector<uint32_t> holder, const Progress& progress) {
  constexpr double kApart = 2;     // texels
  constexpr double kCoarsest = 8;  // how much wider than the mean texel one may be that counts so
  const int n = atlas.resolution;
  std::vector<bool> holds(atlas.corners.size());
  for (const uint32_t t : holder)
    if (t != kNone) holds[t] = true;
  double whole = 0, lost = 0;
  uint32_t first = kNone, beside = kNone;
  for (uint32_t t = 0; t < atlas.corners.size(); ++t) {
    if (t % 1024 == 0 && progress.cancelled()) return {};
    whole += double(areas.world[t]);
    if (holds[t]) continue;
    const auto& c = atlas.corners[t];
    const Vec2 middle = (c[0] + c[1] + c[2]) * (1.0f / 3);
    const auto index = [&](float x) { return size_t(std::clamp(int(x), 0, n - 1)); };
    uint32_t& other = holder[index(middle.y) * size_t(n) + index(middle.x)];
    if (other == kNone) other = t;
    const double own = std::sqrt(double(areas.world[other]) / area_of(atlas, other));
    const double texel_m = std::min(own, kCoarsest * std::sqrt(areas.m2_per_texel));
    if (!(double(distance(world_box(scene, atlas, t), world_box(scene, atlas, other))) >
          kApart * texel_m))
      continue;
    lost += double(areas.world[t]);
    if (first == kNone) first = t, beside = other;
  }
  if (!(lost > kFewWithoutPlace * whole)) return {};
  return fmt::format(
      "{:.0f} % of the surface lie in texels of TEXCOORD_1 at resolution {} that also hold what "
      "lies far away, as {} and {}",
      100 * lost / whole, n, triangle_name(scene, atlas, first),
      triangle_name(scene, atlas, beside));
}

}  // namespace

Result<Atlas> keep_uv1(const scene::Scene& scene, int resolution, const Progress& progress) {
  LUXEL_TRY_STATUS(check_range(scene));
  LUXEL_TRY_STATUS(check_instances(scene));
  Atlas atlas;
  atlas.resolution = resolution, atlas.kept = true;
  atlas.first_triangle = scene::first_triangles(scene);
  add_corners(scene, atlas);
  if (const auto holder = find_holders(scene, atlas, progress); !holder)
    return Failure{holder.error()};
  number_charts(scene, atlas);
  return atlas;
}

Result<std::string> why_no_layout(const scene::Scene& scene, const Atlas& kept,
                                  const Progress& progress) {
  const Areas areas = areas_of(scene, kept);
  std::string why = what_is_collapsed(scene, kept, areas);
  if (!why.empty()) return why;
  LUXEL_TRY(std::vector<uint32_t> holder, find_holders(scene, kept, progress));
  why = what_shares_texels(scene, kept, areas, std::move(holder), progress);
  LUXEL_TRY_STATUS(stopped(progress));
  return why;
}

}  // namespace luxel::atlas
