#include "transport/open_samples.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "base/warp.h"
#include "scene/drawn_triangle.h"
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

/// Looks at some texels' samples, and moves them.
OpenedSamples open_some(const Work& work, std::span<const uint32_t> texels, atlas::TexelMap& map) {
  constexpr size_t kBlock = 2048;
  enum : uint8_t { nothing_near = 0, back_near, moved };
  std::vector<uint8_t> found(texels.size());
  parallel_for(texels.size(), kBlock, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays;
    for (size_t k = begin; k < end; ++k) work.add_feelers(map.texels[texels[k]], rays);
    std::vector<trace::Hit> hits(rays.size());
    work.tracer.closest_hits(rays, hits);
    for (size_t k = begin; k < end; ++k) {
      const auto first = hits.begin() + long((k - begin) * kFeelers);
      if (std::none_of(first, first + kFeelers,
                       [](const trace::Hit& hit) { return hit.found() && hit.back_face; }))
        continue;
      found[k] = back_near;
      atlas::Texel& texel = map.texels[texels[k]];
      if (work.in_the_open(texel.sample)) continue;
      const auto place = work.open_place(texel);
      if (!place) continue;
      texel.sample = *place;
      found[k] = moved;
    }
  });
  OpenedSamples out;
  for (size_t k = 0; k < found.size(); ++k) {
    if (found[k] != nothing_near) out.near_backs.push_back(texels[k]);
    if (found[k] == moved) out.moved.push_back(texels[k]);
  }
  return out;
}

bool meets_any(std::span<const Box3> boxes, const Box3& other, float within_m) {
  const Vec3 r{within_m, within_m, within_m};
  return std::ranges::any_of(boxes, [&](const Box3& box) {
    const Vec3 lower = max(box.lower - r, other.lower), upper = min(box.upper + r, other.upper);
    return lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z;
  });
}

/// Per triangle of the atlas, how near to a box its samples' feelers meet it; < 0: it is too far
/// away for all of them.
std::vector<float> reaches_to(const Work& work, std::span<const Box3> boxes) {
  std::vector<float> out(work.atlas.corners.size(), -1.0f);
  parallel_for(out.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const auto [instance, triangle] =
          scene::drawn_triangle(work.atlas.first_triangle, uint32_t(k));
      // Feelers start a little above their sample, which rounding may put beside the triangle.
      const float reach = kReach * texel_width_m(work.scene, work.atlas, instance, triangle) +
                          1e-4f * work.diagonal_m;
      const scene::Triangle3 t = scene::world_triangle(work.scene, instance, triangle);
      Box3 bounds;
      for (const Vec3& corner : {t.a, t.b, t.c}) bounds.extend(corner);
      if (meets_any(boxes, bounds, reach)) out[k] = reach;
    }
  });
  return out;
}

}  // namespace

OpenedSamples open_samples(const scene::Scene& scene, const atlas::Atlas& atlas,
                           const trace::RayTracer& tracer, atlas::TexelMap& map) {
  std::vector<uint32_t> all(map.texels.size());
  std::iota(all.begin(), all.end(), 0);
  return open_some({scene, atlas, tracer, scene::world_bounds(scene).diagonal()}, all, map);
}

OpenedSamples open_samples_again(const scene::Scene& scene, const atlas::Atlas& atlas,
                                 const trace::RayTracer& tracer, std::span<const Box3> boxes,
                                 std::span<const uint32_t> near_backs, atlas::TexelMap& map) {
  const Work work{scene, atlas, tracer, scene::world_bounds(scene).diagonal()};
  const std::vector<float> reaches = reaches_to(work, boxes);
  std::vector<uint8_t> look(map.texels.size());
  for (const uint32_t i : near_backs) look[i] = 1;
  parallel_for(look.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float reach = reaches[map.texels[i].triangle_number];
      if (look[i] || reach < 0) continue;
      const Vec3 at = scene::world_position(scene, map.texels[i].sample);
      if (meets_any(boxes, {at, at}, reach)) look[i] = 1;
    }
  });
  std::vector<uint32_t> texels;
  for (uint32_t i = 0; i < look.size(); ++i)
    if (look[i]) texels.push_back(i);
  return open_some(work, texels, map);
}

}  // namespace luxel::transport
