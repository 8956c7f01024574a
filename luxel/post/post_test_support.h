// Shared by the tests of this room: a sheet cut into two charts.
#pragma once

#include <cmath>

#include "luxel/atlas/atlas.h"
#include "luxel/scene/scene.h"

namespace luxel::post {

/// Two unit squares side by side in the plane z = 0, with a crease of `angle` between them; 4
/// triangles, vertices welded along the shared edge or not.
inline scene::Scene two_squares(float angle_rad, bool welded) {
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  scene::Scene scene;
  scene::Mesh mesh;
  mesh.positions = {{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0},
                    {c, 0, s},  {c, 1, s}, {0, 0, 0}, {0, 1, 0}};
  const uint32_t low = welded ? 1 : 6, high = welded ? 2 : 7;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {low, 4, 5}, {low, 5, high}};
  mesh.triangle_material = {0, 0, 0, 0};
  scene.materials.resize(1);
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"sheet", 0, {}});
  return scene;
}

/// Lays the squares of two_squares out as two charts of `side` texels: the left one upright at
/// (2, 2), the right one turned by a quarter, at (side + 6.25, 2.5) so that the texel grids differ.
inline atlas::Atlas two_charts(int side) {
  const float s = float(side);
  const auto left = [&](float x, float y) { return Vec2{2 + s * (x + 1), 2 + s * y}; };
  const auto right = [&](float x, float y) { return Vec2{s + 6.25f + s * y, 2.5f + s * x}; };
  atlas::Atlas atlas;
  atlas.resolution = 2 * side + 12;
  atlas.first_triangle = {0, 4};
  atlas.corners = {{left(-1, 0), left(0, 0), left(0, 1)},
                   {left(-1, 0), left(0, 1), left(-1, 1)},
                   {right(0, 0), right(1, 0), right(1, 1)},
                   {right(0, 0), right(1, 1), right(0, 1)}};
  atlas.chart = {0, 0, 1, 1};
  atlas.chart_count = 2;
  return atlas;
}

/// Every texel that a chart's rectangle touches; `triangle_number` 0 in the left chart, 2 in the
/// right one.
inline atlas::TexelMap two_chart_map(int side) {
  const float s = float(side);
  const int n = 2 * side + 12;
  atlas::TexelMap map;
  map.resolution = n;
  map.texel_at.assign(size_t(n) * size_t(n), atlas::kNone);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto inside = [&](float x0, float y0) {
        return float(x + 1) > x0 && float(x)<x0 + s&& float(y + 1)> y0 && float(y) < y0 + s;
      };
      const bool left = inside(2, 2), right = inside(s + 6.25f, 2.5f);
      if (!left && !right) continue;
      map.texel_at[size_t(y * n + x)] = uint32_t(map.texels.size());
      map.texels.push_back({uint16_t(x), uint16_t(y), {}, left ? 0u : 2u, true});
    }
  return map;
}

}  // namespace luxel::post
