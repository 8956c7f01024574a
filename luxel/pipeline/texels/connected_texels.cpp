#include "luxel/pipeline/texels/connected_texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "luxel/pipeline/texels/texel_layout.h"
#include "luxel/post/seams.h"
#include "luxel/transport/barriers.h"
#include "luxel/transport/texel_width.h"

namespace luxel::pipeline {
namespace {

/// The largest angle between the shading normals on both sides of a seam: that which the denoiser
/// mixes, and more than stitching ties together.
constexpr float kMaxAngle_rad = 0.35f;

/// Sets that grow together; each is known by the least of its members.
struct Joined {
  std::vector<uint32_t> least;

  explicit Joined(size_t count) : least(count) { std::iota(least.begin(), least.end(), 0u); }
  uint32_t root(uint32_t i) {
    while (least[i] != i) i = least[i] = least[least[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) {
    a = root(a), b = root(b);
    least[std::max(a, b)] = std::min(a, b);
  }
};

/// The open texels of a triangle's chart that a look-up at a place of the atlas reads.
struct Read {
  std::array<uint32_t, 4> texel{};
  size_t count = 0;
};
Read read_at(const light::TexelScene& in, std::span<const uint8_t> hidden, uint32_t triangle,
             Vec2 at) {
  const int side = in.map.resolution;
  const int x0 = int(std::floor(at.x - 0.5f)), y0 = int(std::floor(at.y - 0.5f));
  Read out;
  for (int k = 0; k < 4; ++k) {
    const int x = x0 + k % 2, y = y0 + k / 2;
    if (x < 0 || y < 0 || x >= side || y >= side) continue;
    const uint32_t i = in.map.texel_at[size_t(y) * size_t(side) + size_t(x)];
    if (i == atlas::kNone || hidden[i]) continue;
    if (in.atlas.chart[in.map.texels[i].triangle_number] == in.atlas.chart[triangle])
      out.texel[out.count++] = i;
  }
  return out;
}

/// The samples of two texels, one on each side of a seam, are open to each other.
bool are_open(const light::TexelScene& in, uint32_t a, uint32_t b) {
  const auto place = [&](uint32_t texel) {
    const atlas::Texel& t = in.map.texels[texel];
    return transport::ChartPoint{transport::flat_point(in.scene, t.sample),
                                 in.atlas.chart[t.triangle_number]};
  };
  const scene::SurfacePoint& p = in.map.texels[a].sample;
  return transport::is_open_between(
      in.scene, in.atlas, in.tracer, place(a), place(b),
      transport::texel_width_m(in.scene, in.atlas, p.instance, p.triangle));
}

/// Joins what an open seam has on both sides.
void join_over(const light::TexelScene& in, std::span<const uint8_t> hidden, const post::Seam& seam,
               Joined& regions) {
  const float texels = std::max(length(seam.a1 - seam.a0), length(seam.b1 - seam.b0));
  const int count = std::max(2, int(std::ceil(2 * texels)));
  for (int k = 0; k < count; ++k) {
    const float s = (float(k) + 0.5f) / float(count);
    const Read a = read_at(in, hidden, seam.triangle_a, seam.a0 * (1 - s) + seam.a1 * s);
    const Read b = read_at(in, hidden, seam.triangle_b, seam.b0 * (1 - s) + seam.b1 * s);
    for (size_t i = 0; i < a.count; ++i)
      for (size_t j = 0; j < b.count; ++j)
        if (regions.root(a.texel[i]) != regions.root(b.texel[j]) &&
            are_open(in, a.texel[i], b.texel[j]))
          regions.join(a.texel[i], b.texel[j]);
  }
}

}  // namespace

Result<std::vector<uint32_t>> connected_texels(const light::TexelScene& in,
                                               std::span<const uint8_t> hidden, Progress& progress,
                                               Team* team) {
  Joined regions(in.map.texels.size());
  const auto join = [&](uint32_t a, uint32_t b) {
    if (!hidden[a] && !hidden[b]) regions.join(a, b);
  };
  LUXEL_TRY_STATUS(
      transport::for_open_neighbours(in.scene, in.atlas, in.map, in.tracer, join, progress, team));
  LUXEL_TRY(const std::vector<post::Seam> open,
            open_seams(in.scene, in.atlas, in.tracer,
                       post::find_seams(in.scene, in.atlas, kMaxAngle_rad), progress, team));
  for (const post::Seam& seam : open) join_over(in, hidden, seam, regions);
  for (uint32_t i = 0; i < regions.least.size(); ++i) regions.least[i] = regions.root(i);
  return std::move(regions.least);
}

}  // namespace luxel::pipeline
