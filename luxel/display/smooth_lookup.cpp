#include "luxel/display/smooth_lookup.h"

#include <cmath>

#include "luxel/display/bilinear.h"

namespace luxel::display {
namespace {

/// The quadratic B-spline, `away` texels from its middle.
float spline(float away) {
  const float d = std::abs(away);
  if (d < 0.5f) return 0.75f - d * d;
  return d < 1.5f ? 0.5f * (1.5f - d) * (1.5f - d) : 0;
}

/// True where the 3 x 3 texels around one of the 4 x 4 are all inside.
bool is_surrounded(const std::array<bool, 16>& inside, size_t x, size_t y) {
  for (size_t j = y - 1; j <= y + 1; ++j)
    for (size_t i = x - 1; i <= x + 1; ++i)
      if (!inside[4 * j + i]) return false;
  return true;
}

/// A place `at` [texels] of a square or a picture. `is_inside(x, y)`: whether there is a texel that
/// lies inside the chart; `value(x, y)`: its light.
template <class IsInside, class Value, class Otherwise>
Rgb smooth_at(Vec2 at, const IsInside& is_inside, const Value& value, const Otherwise& bilinear) {
  const int x0 = int(std::floor(at.x - 0.5f)), y0 = int(std::floor(at.y - 0.5f));
  std::array<bool, 16> inside;
  for (int k = 0; k < 16; ++k) inside[size_t(k)] = is_inside(x0 - 1 + k % 4, y0 - 1 + k / 4);
  const SmoothWeights w =
      smooth_weights({at.x - 0.5f - float(x0), at.y - 0.5f - float(y0)}, inside);
  Rgb sum{};
  for (int k = 0; k < 16; ++k)
    if (const float weight = w.share * w.weight[size_t(k)]; weight > 0)
      sum += value(x0 - 1 + k % 4, y0 - 1 + k / 4) * weight;
  return w.share < 1 ? sum + bilinear() * (1 - w.share) : sum;
}

}  // namespace

SmoothWeights smooth_weights(Vec2 to, const std::array<bool, 16>& inside) {
  SmoothWeights out;
  for (size_t k = 0; k < 4; ++k) {
    const size_t i = k % 2, j = k / 2;
    if (is_surrounded(inside, i + 1, j + 1))
      out.share += (i ? to.x : 1 - to.x) * (j ? to.y : 1 - to.y);
  }
  if (out.share <= 0) return out;
  float sum = 0;
  for (size_t k = 0; k < 16; ++k) {
    const float dx = to.x + 1 - float(k % 4), dy = to.y + 1 - float(k / 4);
    out.weight[k] = inside[k] ? spline(dx) * spline(dy) : 0;
    sum += out.weight[k];
  }
  for (float& w : out.weight) w /= sum;
  return out;
}

Rgb smooth_at(const image::Image& picture, Vec2 uv) {
  const auto bilinear = [&] { return bilinear_at(picture, uv); };
  if (picture.channels < 4) return bilinear();
  return smooth_at(
      {uv.x * float(picture.width), uv.y * float(picture.height)},
      [&](int x, int y) {
        return x >= 0 && y >= 0 && x < picture.width && y < picture.height &&
               picture.at(x, y)[3] >= 1;
      },
      [&](int x, int y) { return picture.rgb(x, y); }, bilinear);
}

Rgb smooth_lightmap_at(const scene::Scene& scene, const image::Image& lightmap,
                       const scene::SurfacePoint& p) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
  if (mesh.uv1.empty()) return {};
  const auto& t = mesh.triangles[p.triangle];
  return smooth_at(lightmap, interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], p.at));
}

Rgb smooth_irradiance_at(const transport::TexelField& field, const scene::SurfacePoint& p) {
  const atlas::Atlas& atlas = *field.atlas;
  const uint32_t triangle = atlas.triangle_number(p.instance, p.triangle);
  const auto& corners = atlas.corners[triangle];
  const int side = field.map->resolution;
  const auto texel_at = [&](int x, int y) {
    const bool is_there = x >= 0 && y >= 0 && x < side && y < side;
    return is_there ? field.map->texel_at[size_t(y) * size_t(side) + size_t(x)] : atlas::kNone;
  };
  return smooth_at(
      interpolate(corners[0], corners[1], corners[2], p.at),
      [&](int x, int y) {
        const uint32_t i = texel_at(x, y);
        if (i == atlas::kNone) return false;
        const atlas::Texel& texel = field.map->texels[i];
        return texel.centre_covered && atlas.chart[texel.triangle_number] == atlas.chart[triangle];
      },
      [&](int x, int y) { return field.irradiance[texel_at(x, y)]; },
      [&] { return transport::irradiance_at(field, p); });
}

}  // namespace luxel::display
