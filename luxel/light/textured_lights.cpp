#include "luxel/light/textured_lights.h"

#include <algorithm>
#include <bit>
#include <queue>

namespace luxel::light {
namespace {

/// Cells per side of the triangle: two to a texel, within these bounds.
constexpr int kMinLevels = 3, kMaxLevels = 8;
/// A piece is not cut whose light varies by less than this part of the triangle's.
constexpr double kVaries = 0.01;
constexpr float kLeastShare = 1e-3f;

using Corners = std::array<Barycentric, 3>;

Barycentric middle(Barycentric p, Barycentric q) {
  return {0.5f * (p.u + q.u), 0.5f * (p.v + q.v)};
}

/// A quarter of a triangle: those at its corners, and the one between them; all turn as it does.
Corners quarter(const Corners& c, uint32_t k) {
  const Barycentric ab = middle(c[0], c[1]), bc = middle(c[1], c[2]), ca = middle(c[2], c[0]);
  switch (k) {
    case 0:
      return {c[0], ab, ca};
    case 1:
      return {ab, c[1], bc};
    case 2:
      return {ca, bc, c[2]};
    default:
      return {bc, ca, ab};
  }
}

/// The part of the triangle that `levels` quarterings lead to: two bits of `path` each.
Corners part_of(const Corners& whole, int levels, size_t path) {
  Corners c = whole;
  for (int k = levels - 1; k >= 0; --k) c = quarter(c, uint32_t(path >> (2 * k)) & 3);
  return c;
}

/// Texels of a texture along the triangle's longest side.
float texels_across(const scene::Scene& scene, const TriangleLight& light,
                    const scene::TextureRef& ref) {
  if (ref.texture == scene::kNone) return 0;
  const scene::Mesh& mesh = scene.meshes[scene.instances[light.instance].mesh];
  const std::vector<Vec2>& uv = ref.uv_set == 1 ? mesh.uv1 : mesh.uv0;
  if (uv.empty()) return 0;
  const scene::Texture& texture = scene.textures[ref.texture];
  const float size = float(std::max(texture.width, texture.height)) *
                     std::max(std::abs(ref.scale.x), std::abs(ref.scale.y));
  const auto& corners = mesh.triangles[light.triangle];
  float longest = 0;
  for (size_t k = 0; k < 3; ++k) {
    const Vec2 side = uv[corners[(k + 1) % 3]] - uv[corners[k]];
    longest = std::max({longest, std::abs(side.x), std::abs(side.y)});
  }
  return longest * size;
}

int levels_for(const scene::Scene& scene, const TriangleLight& light) {
  const scene::Material& m = scene::material_at(scene, {light.instance, light.triangle, {}});
  float texels = 0;
  for (const scene::TextureRef* ref : scene::textures_of(m))
    texels = std::max(texels, texels_across(scene, light, *ref));
  const float cells = std::clamp(2 * texels, 1.0f, float(1 << kMaxLevels));
  return std::clamp(int(std::bit_width(uint32_t(std::ceil(cells)) - 1)), kMinLevels, kMaxLevels);
}

/// Sums over the cells below a part of the triangle.
struct Sums {
  Rgb radiance{};
  double luminance = 0, squares = 0;
};

/// sums[l][path]: of the part that l quarterings lead to.
using Pyramid = std::vector<std::vector<Sums>>;

Pyramid measure(const scene::Scene& scene, const TriangleLight& light, int levels) {
  Pyramid sums(size_t(levels) + 1);
  auto& cells = sums.back();
  cells.resize(size_t(1) << (2 * levels));
  for (size_t path = 0; path < cells.size(); ++path) {
    const Corners c = part_of(kWholeTriangle, levels, path);
    const Barycentric centre{(c[0].u + c[1].u + c[2].u) / 3, (c[0].v + c[1].v + c[2].v) / 3};
    const Rgb radiance = radiance_at(scene, light, centre);
    const double l = double(luminance(radiance));
    cells[path] = {radiance, l, l * l};
  }
  for (int level = levels - 1; level >= 0; --level) {
    const auto& below = sums[size_t(level) + 1];
    auto& here = sums[size_t(level)];
    here.resize(below.size() / 4);
    for (size_t path = 0; path < below.size(); ++path) {
      Sums& s = here[path / 4];
      s.radiance += below[path].radiance;
      s.luminance += below[path].luminance, s.squares += below[path].squares;
    }
  }
  return sums;
}

struct Piece {
  int level = 0;
  size_t path = 0;
  double variation = 0;  ///< standard deviation of the luminance times cells

  bool operator<(const Piece& other) const {
    return std::pair(variation, other.path) < std::pair(other.variation, path);
  }
};

Piece piece_at(const Pyramid& sums, int level, size_t path) {
  const Sums& s = sums[size_t(level)][path];
  const double cells = double(sums.back().size() / sums[size_t(level)].size());
  const double mean = s.luminance / cells;
  return {level, path, cells * std::sqrt(std::max(0.0, s.squares / cells - mean * mean))};
}

/// The parts that together are the triangle, in the order in which they lie in it.
std::vector<Piece> cut(const Pyramid& sums, size_t max_pieces) {
  const int levels = int(sums.size()) - 1;
  std::priority_queue<Piece> open;
  std::vector<Piece> pieces;
  open.push(piece_at(sums, 0, 0));
  while (!open.empty()) {
    const Piece piece = open.top();
    open.pop();
    const bool even = piece.variation <= kVaries * sums[0][0].luminance;
    if (even || piece.level == levels || pieces.size() + open.size() + 4 > max_pieces) {
      pieces.push_back(piece);
      continue;
    }
    for (size_t k = 0; k < 4; ++k) open.push(piece_at(sums, piece.level + 1, 4 * piece.path + k));
  }
  const auto place = [&](const Piece& p) { return p.path << (2 * (levels - p.level)); };
  std::sort(pieces.begin(), pieces.end(),
            [&](const Piece& p, const Piece& q) { return place(p) < place(q); });
  return pieces;
}

}  // namespace

std::vector<TriangleLight> pieces_by_brightness(const scene::Scene& scene,
                                                const TriangleLight& light, size_t max_pieces) {
  const Pyramid sums = measure(scene, light, levels_for(scene, light));
  const float cells = float(sums.back().size());
  const scene::Material& m = scene::material_at(scene, {light.instance, light.triangle, {}});
  Rgb least = sums[0][0].radiance * (kLeastShare / cells);
  if (max_component(least) <= 0) least = m.emission * kLeastShare;
  std::vector<TriangleLight> out;
  for (const Piece& piece : cut(sums, max_pieces)) {
    TriangleLight part = light;
    part.part = part_of(kWholeTriangle, piece.level, piece.path);
    part.a = interpolate(light.a, light.b, light.c, part.part[0]);
    part.b = interpolate(light.a, light.b, light.c, part.part[1]);
    part.c = interpolate(light.a, light.b, light.c, part.part[2]);
    const float share = 1 / float(sums[size_t(piece.level)].size());
    part.area_m2 = light.area_m2 * share;
    part.mean_radiance =
        max(sums[size_t(piece.level)][piece.path].radiance / (cells * share), least);
    part.piece = uint32_t(out.size());
    out.push_back(part);
  }
  return out;
}

}  // namespace luxel::light
