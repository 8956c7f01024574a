#include "luxel/view/model/uv_overlaps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxel::view {
namespace {

constexpr int kPixelsPerTexel = 2;
constexpr float kInside = 1e-3f;  ///< so far from its edges does a triangle cover a place [pixels]

/// Calls cover(x, y) for each pixel whose middle lies within a triangle, corners in pixels.
template <class Cover>
void cover_triangle(std::array<Vec2, 3> c, int width, int height, const Cover& cover) {
  if (cross(c[1] - c[0], c[2] - c[0]) < 0) std::swap(c[1], c[2]);
  const auto clamped = [](float v, int most) { return int(std::clamp(v, 0.0f, float(most))); };
  const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
  const auto [top, bottom] = std::minmax({c[0].y, c[1].y, c[2].y});
  for (int y = clamped(top, height); y < clamped(bottom + 1, height); ++y)
    for (int x = clamped(left, width); x < clamped(right + 1, width); ++x) {
      const Vec2 middle{float(x) + 0.5f, float(y) + 0.5f};
      bool is_inside = true;
      for (size_t k = 0; k < 3; ++k) {
        const Vec2 from = c[k], along = c[(k + 1) % 3] - from;
        is_inside &= cross(along, middle - from) > kInside * length(along);
      }
      if (is_inside) cover(x, y);
    }
}

}  // namespace

std::vector<image::Image8> uv_overlaps(const scene::Scene& scene,
                                       const pipeline::LightmapPages& lightmaps,
                                       std::span<const std::vector<Vec2>> light_uv) {
  std::vector<image::Image8> out;
  for (const image::Image& page : lightmaps.pictures) {
    const int width = kPixelsPerTexel * page.width, height = kPixelsPerTexel * page.height;
    out.push_back({width, height, 1, std::vector<uint8_t>(size_t(width) * size_t(height))});
  }
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    const std::vector<Vec2>& places = light_uv.empty() ? mesh.uv1 : light_uv[instance.mesh];
    if (places.empty()) continue;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      const uint32_t material = mesh.triangle_material[t];
      if (scene.materials[material].unlit) continue;
      image::Image8& page = out[lightmaps.of_material[material]];
      std::array<Vec2, 3> corners;
      for (size_t k = 0; k < 3; ++k) {
        const Vec2 uv = places[mesh.triangles[t][k]];
        corners[k] = {uv.x * float(page.width), uv.y * float(page.height)};
      }
      cover_triangle(corners, page.width, page.height, [&](int x, int y) {
        uint8_t& count = page.data[size_t(y) * size_t(page.width) + size_t(x)];
        count = uint8_t(std::min(count + 1, 2));
      });
    }
  }
  for (image::Image8& page : out)
    for (uint8_t& count : page.data) count = count > 1 ? 255 : 0;
  return out;
}

}  // namespace luxel::view
