#include "luxel/pipeline/bake/page_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/atlas/pages.h"
#include "luxel/transport/texel_width.h"

namespace luxel::pipeline {
namespace {

/// In texels; and how much farther than the nearest place others may be that are as good.
constexpr float kReach = 1.5f, kAsNear = 1.25f;

/// Cells of space, as large as texels reach, 21 bits an axis.
struct Cells {
  Vec3 lower;
  float side_m = 1;

  uint64_t key(Vec3 p, int dx = 0, int dy = 0, int dz = 0) const {
    const auto along = [&](float x, float x0, int d) {
      return uint64_t(std::clamp<int64_t>(int64_t((x - x0) / side_m) + d, 0, (1 << 21) - 1));
    };
    return along(p.x, lower.x, dx) << 42 | along(p.y, lower.y, dy) << 21 | along(p.z, lower.z, dz);
  }
  std::array<uint64_t, 27> around(Vec3 p) const {
    std::array<uint64_t, 27> out;
    for (int k = 0; k < 27; ++k) out[size_t(k)] = key(p, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    return out;
  }
};

Vec3 texel_place(const Bake& bake, uint32_t texel) {
  return scene::world_position(bake.scene, bake.map.texels[texel].sample);
}

/// Hidden texels that were not refilled.
std::vector<uint32_t> dark_texels(const Bake& bake) {
  std::vector<uint8_t> dark = bake.light.hidden;
  for (const uint32_t i : bake.repair.refilled) dark[i] = 0;
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < dark.size(); ++i)
    if (dark[i]) out.push_back(i);
  return out;
}

/// The reach of dark texels, or 0 where that is not known, and the cells of the farthest.
struct Reaches {
  std::vector<float> of;  ///< [m]
  Cells cells;
};
Reaches reaches_of(const Bake& bake, std::span<const uint32_t> dark) {
  Reaches out;
  double sum = 0;
  for (const uint32_t i : dark) {
    const scene::SurfacePoint& p = bake.map.texels[i].sample;
    out.of.push_back(kReach *
                     transport::texel_width_m(bake.scene, bake.atlas, p.instance, p.triangle));
    sum += double(out.of.back());
  }
  // Texels far larger than most look no farther than twice the mean.
  const float most = float(2 * sum / double(dark.size()));
  for (float& r : out.of) r = std::min(r, most);
  const Box3 box = scene::world_bounds(bake.scene);
  out.cells = {box.lower, std::max({most, box.diagonal() / float(1 << 20), 1e-30f})};
  return out;
}

struct InCell {
  uint64_t key = 0;
  uint32_t texel = 0;
};

/// The texels in the open that lie in cells beside dark ones, sorted by their cells.
std::vector<InCell> open_beside(const Bake& bake, std::span<const uint32_t> dark,
                                const Cells& cells) {
  std::vector<uint64_t> beside;
  uint64_t last = UINT64_MAX;
  for (const uint32_t i : dark) {
    const Vec3 p = texel_place(bake, i);
    if (cells.key(p) == std::exchange(last, cells.key(p))) continue;
    const auto around = cells.around(p);
    beside.insert(beside.end(), around.begin(), around.end());
  }
  std::ranges::sort(beside);
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  std::vector<InCell> out;
  for (uint32_t i = 0; i < bake.map.texels.size(); ++i) {
    if (bake.light.hidden[i]) continue;
    const uint64_t key = cells.key(texel_place(bake, i));
    if (std::ranges::binary_search(beside, key)) out.push_back({key, i});
  }
  std::ranges::stable_sort(out, {}, &InCell::key);
  return out;
}

/// The darkest of those that are about as near to a place as the nearest one; kNone: all are
/// farther than `reach` [m].
uint32_t lender_of(const Bake& bake, std::span<const InCell> open, const Cells& cells, Vec3 place,
                   float reach) {
  const auto for_near = [&](const auto& visit) {
    for (const uint64_t key : cells.around(place))
      for (auto near = std::ranges::lower_bound(open, key, {}, &InCell::key);
           near != open.end() && near->key == key; ++near)
        visit(near->texel, length(texel_place(bake, near->texel) - place));
  };
  float nearest = INFINITY;
  for_near([&](uint32_t, float away) { nearest = std::min(nearest, away); });
  uint32_t out = atlas::kNone;
  if (nearest > reach) return out;
  const auto light = [&](uint32_t i) { return luminance(bake.light.irradiance[i]); };
  for_near([&](uint32_t i, float away) {
    if (away > kAsNear * nearest) return;
    if (out == atlas::kNone || light(i) < light(out)) out = i;
  });
  return out;
}

}  // namespace

std::vector<Lent> light_for_hidden(const Bake& bake) {
  std::vector<Lent> out;
  const std::vector<uint32_t> dark = dark_texels(bake);
  if (dark.empty()) return out;
  const Reaches reaches = reaches_of(bake, dark);
  const std::vector<InCell> open = open_beside(bake, dark, reaches.cells);
  for (size_t k = 0; k < dark.size(); ++k) {
    const uint32_t from =
        lender_of(bake, open, reaches.cells, texel_place(bake, dark[k]), reaches.of[k]);
    if (from != atlas::kNone) out.push_back({dark[k], from});
  }
  return out;
}

std::vector<image::Image> for_page(const Bake& bake, std::span<const Lent> lent,
                                   std::span<const image::Image> lightmaps) {
  std::vector<image::Image> pages(lightmaps.begin(), lightmaps.end());
  const std::vector<atlas::Page> places = atlas::pages_of(bake.atlas);
  const size_t side = size_t(bake.map.resolution);
  for (size_t p = 0; p < pages.size(); ++p)
    for (int y = 0; y < pages[p].height; ++y)
      for (int x = 0; x < pages[p].width; ++x) {
        float& alpha = pages[p].at(x, y)[3];
        const size_t at = size_t(y + places[p].y) * side + size_t(x + places[p].x);
        if (alpha > 0 && bake.map.texel_at[at] == atlas::kNone) alpha = kDilatedAlpha;
      }
  const auto pixel = [&](uint32_t i) {
    const atlas::Texel& t = bake.map.texels[i];
    const uint32_t p = atlas::page_of(bake.atlas, t.triangle_number);
    return pages[p].at(int(t.x) - places[p].x, int(t.y) - places[p].y);
  };
  for (const Lent& l : lent) std::copy_n(pixel(l.from), 3, pixel(l.texel));
  return pages;
}

}  // namespace luxel::pipeline
