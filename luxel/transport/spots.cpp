#include "luxel/transport/spots.h"

#include <algorithm>

#include "luxel/transport/texel_width.h"

namespace luxel::transport {
namespace {

/// Texels of other charts that lie farther away than so many texels are no neighbours in space.
constexpr float kFarTexels = 3;
Vec3 line_end(const Spot& s, float height) {
  return s.at.position + s.at.normal * (height * s.width_m);
}

}  // namespace

trace::Ray line_between(const Spot& a, const Spot& b) {
  const Vec3 from = line_end(a, a.line_height);
  return {from, 0, line_end(b, b.line_height) - from, 1};
}
trace::Ray line_up(const Spot& s) {
  const Vec3 from = line_end(s, kLowHeight);
  return {from, 0, line_end(s, kLineHeight) - from, 1};
}

Spot SpotMaker::spot(const scene::SurfacePoint& p) {
  if (p.instance != instance || p.triangle != triangle) {
    instance = p.instance, triangle = p.triangle;
    facet = scene::facet_of(scene, instance, triangle);
    const uint32_t number = atlas.triangle_number(instance, triangle);
    last = {{{}, facet.front, facet.size_m},
            atlas.chart[number],
            texel_width_m(atlas, number, facet.corners)};
  }
  const scene::Triangle3& t = facet.corners;
  last.at.position = interpolate(t.a, t.b, t.c, p.at);
  return last;
}

Spot spot_at(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
             const scene::SurfacePoint& p) {
  return spots_at(scene, atlas, tracer, {&p, 1}).front();
}

void spots_at(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
              std::span<const scene::SurfacePoint> places, SpotBuffers& buffers,
              std::vector<Spot>& out) {
  SpotMaker maker{scene, atlas};
  out.clear(), buffers.rays.clear();
  for (const scene::SurfacePoint& p : places)
    out.push_back(maker.spot(p)), buffers.rays.push_back(line_up(out.back()));
  buffers.hits.resize(buffers.rays.size());
  tracer.closest_hits(buffers.rays, buffers.hits);
  for (size_t k = 0; k < out.size(); ++k)
    if (buffers.hits[k].found()) out[k].line_height = kLowHeight;
}

std::vector<Spot> spots_at(const scene::Scene& scene, const atlas::Atlas& atlas,
                           const trace::RayTracer& tracer,
                           std::span<const scene::SurfacePoint> places) {
  SpotBuffers buffers;
  std::vector<Spot> out;
  spots_at(scene, atlas, tracer, places, buffers, out);
  return out;
}

bool is_far(const Spot& a, const Spot& b) {
  return a.chart != b.chart &&
         length(b.at.position - a.at.position) > kFarTexels * std::max(a.width_m, b.width_m);
}

bool is_between(const scene::Scene& scene, const atlas::Atlas& atlas, const Spot& a, const Spot& b,
                const trace::Hit& hit) {
  return is_barrier(scene, atlas, a.chart, hit) && is_barrier(scene, atlas, b.chart, hit);
}

bool sees(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
          const Spot& a, const Spot& b) {
  return !is_far(a, b) && !is_between(scene, atlas, a, b, tracer.closest_hit(line_between(a, b)));
}

std::vector<uint64_t> blocks_of(const atlas::TexelMap& map, std::span<const uint8_t> marked) {
  const uint32_t side = border_side(map);
  std::vector<uint64_t> out((size_t(side) * side + 63) / 64);
  for (size_t i = 0; i < marked.size(); ++i) {
    if (!marked[i]) continue;
    const uint32_t last = (map.texels[i].y + 1u) * side + map.texels[i].x + 1u;
    for (const uint32_t base : {last, last - 1, last - side, last - side - 1})
      out[base / 64] |= uint64_t(1) << (base % 64);
  }
  return out;
}

}  // namespace luxel::transport
