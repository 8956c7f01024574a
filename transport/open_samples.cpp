#include "transport/open_samples.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/parallel.h"
#include "base/warp.h"
#include "transport/backs_seen.h"
#include "transport/barriers.h"
#include "transport/texel_width.h"

namespace luxel::transport {
namespace {

constexpr int kGrid = 4;        ///< places looked at along a texel's side
constexpr int kFeelers = 6;     ///< short rays around a sample
constexpr float kReach = 1.5f;  ///< their length in texels
constexpr int kFirstRays = 8, kRaysForOpen = 32;

struct Work {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const trace::RayTracer& tracer;
  float diagonal_m;

  Vec3 just_above(const Place& p) const {
    return trace::offset_origin(p.position, p.normal, diagonal_m);
  }
  bool in_the_open(const scene::SurfacePoint& p) const {
    const Place at = place_of(scene, p);
    // Most places under things see nothing but backs: a few rays tell.
    return !is_enclosed(backs_seen(scene, tracer, just_above(at), at.normal, kFirstRays)) &&
           !is_enclosed(scene, tracer, just_above(at), at.normal, kRaysForOpen, diagonal_m);
  }
  /// Short rays around the sample, twenty degrees above the surface.
  void add_feelers(const atlas::Texel& texel, std::vector<trace::Ray>& rays) const {
    const Place at = place_of(scene, texel.sample);
    const Vec3 from = just_above(at);
    const float reach =
        kReach * texel_width_m(scene, atlas, texel.sample.instance, texel.sample.triangle);
    const auto frame = frame_around(at.normal);
    for (int k = 0; k < kFeelers; ++k) {
      const float turn = 2 * kPi * float(k) / kFeelers;
      const Vec3 d{0.94f * std::cos(turn), 0.94f * std::sin(turn), 0.34f};
      rays.push_back({from, 0, frame.to_world(d), reach});
    }
  }

  std::optional<scene::SurfacePoint> open_place(const atlas::Texel& texel) const;
};

std::optional<scene::SurfacePoint> Work::open_place(const atlas::Texel& texel) const {
  const auto& corners = atlas.corners[texel.triangle_number];
  const Vec2 sample = interpolate(corners[0], corners[1], corners[2], texel.sample.at);
  struct Candidate {
    float distance;
    Barycentric at;
  };
  std::vector<Candidate> candidates;
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i) {
      const Vec2 p{float(texel.x) + (float(i) + 0.5f) / kGrid,
                   float(texel.y) + (float(j) + 0.5f) / kGrid};
      const Barycentric at = atlas::barycentric_in(corners, p);
      if (at.u > 0 && at.v > 0 && at.u + at.v < 1) candidates.push_back({length(p - sample), at});
    }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& p, const Candidate& q) { return p.distance < q.distance; });
  for (const Candidate& c : candidates) {
    const scene::SurfacePoint place{texel.sample.instance, texel.sample.triangle, c.at};
    if (in_the_open(place)) return place;
  }
  return {};
}

}  // namespace

std::vector<uint32_t> open_samples(const scene::Scene& scene, const atlas::Atlas& atlas,
                                   const trace::RayTracer& tracer, atlas::TexelMap& map) {
  constexpr size_t kBlock = 2048;
  const Work work{scene, atlas, tracer, scene::world_bounds(scene).diagonal()};
  std::vector<uint8_t> moved(map.texels.size());
  parallel_for(map.texels.size(), kBlock, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays;
    for (size_t i = begin; i < end; ++i) work.add_feelers(map.texels[i], rays);
    std::vector<trace::Hit> hits(rays.size());
    tracer.closest_hits(rays, hits);
    for (size_t i = begin; i < end; ++i) {
      const auto first = hits.begin() + long((i - begin) * kFeelers);
      const bool back_near = std::any_of(first, first + kFeelers, [](const trace::Hit& hit) {
        return hit.found() && hit.back_face;
      });
      if (!back_near || work.in_the_open(map.texels[i].sample)) continue;
      const auto place = work.open_place(map.texels[i]);
      if (!place) continue;
      map.texels[i].sample = *place;
      moved[i] = 1;
    }
  });
  std::vector<uint32_t> all;
  for (uint32_t i = 0; i < moved.size(); ++i)
    if (moved[i]) all.push_back(i);
  return all;
}

}  // namespace luxel::transport
