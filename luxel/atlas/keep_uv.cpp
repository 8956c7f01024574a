#include "luxel/atlas/keep_uv.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "luxel/atlas/cover.h"
#include "luxel/scene/drawn_triangle.h"

namespace luxel::atlas {
namespace {

/// What a user can find a drawn triangle by.
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
      return fail(ErrorCode::bad_setting, "--uv keep: mesh '{}' has no TEXCOORD_1; use --uv unwrap",
                  mesh.name);
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const uint32_t v : mesh.triangles[t]) {
        const Vec2 uv = mesh.uv1[v];
        if (!(uv.x >= -kRounding && uv.x <= 1 + kRounding && uv.y >= -kRounding &&
              uv.y <= 1 + kRounding))
          return fail(ErrorCode::bad_input,
                      "--uv keep: triangle {} of mesh '{}' has TEXCOORD_1 ({}, {}) outside [0, 1]; "
                      "use --uv unwrap",
                      t, mesh.name, uv.x, uv.y);
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

Status check_overlap(const scene::Scene& scene, const Atlas& atlas, const Progress& progress) {
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
                      "--uv keep: TEXCOORD_1 overlaps at resolution {}: the centre of texel "
                      "({}, {}) lies in {} and in {}; use --uv unwrap",
                      n, i, j, triangle_name(scene, atlas, other), triangle_name(scene, atlas, t));
        other = t;
      }
    }
  }
  return {};
}

Status check_instances(const scene::Scene& scene) {
  std::vector<uint32_t> user(scene.meshes.size(), kNone);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const uint32_t m = scene.instances[i].mesh;
    if (scene.meshes[m].triangles.empty()) continue;
    if (user[m] != kNone)
      return fail(ErrorCode::bad_input,
                  "--uv keep: instances {} '{}' and {} '{}' share mesh '{}' and so triangle 0 of "
                  "both lies at one place of TEXCOORD_1; use --uv unwrap",
                  user[m], scene.instances[user[m]].name, i, scene.instances[i].name,
                  scene.meshes[m].name);
    user[m] = i;
  }
  return {};
}

}  // namespace

Result<Atlas> keep_uv1(const scene::Scene& scene, int resolution, const Progress& progress) {
  LUXEL_TRY_STATUS(check_range(scene));
  LUXEL_TRY_STATUS(check_instances(scene));
  Atlas atlas;
  atlas.resolution = resolution, atlas.kept = true;
  atlas.first_triangle = scene::first_triangles(scene);
  add_corners(scene, atlas);
  LUXEL_TRY_STATUS(check_overlap(scene, atlas, progress));
  number_charts(scene, atlas);
  return atlas;
}

}  // namespace luxel::atlas
