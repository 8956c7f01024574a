#include "luxel/solve/gather/trace/follow_on.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "luxel/base/random.h"
#include "luxel/transport/back_faces.h"

namespace luxel::gather {
namespace {

/// Notes what a ray that was followed on brings (1) or no longer brings (-1). `hit` is its own, if
/// it has one.
void note_change(const RayScene& in, const FollowedRay& ray, StoredHit hit, float sign,
                 size_t element, TracedHits& out) {
  if (!in.sent || out.unknown[element]) return;
  out.change[element] += ray.light * (sign * kPi);
  if (ray.has_hit()) gather::note_change(in, hit, sign, element, out);
}

/// Adds radiance that a ray has brought without the map.
void add_light(const FollowedRay& ray, size_t element, TracedHits& out) {
  const float l = luminance(ray.light);
  out.sky[element] += ray.light;
  out.sky_luminance2[element] += l * l;
  out.sky_first_less_second[element] += ray.way().second_half ? -l : l;
}

/// The followed rays of an earlier bake's element, one after another.
struct KnownFollowed {
  std::span<const FollowedRay> rays;
  std::span<const StoredHit> hits;     ///< of those that have one
  std::span<const uint32_t> retraced;  ///< numbers of the element's rays that were traced again

  explicit KnownFollowed(const EarlierElement& e, std::span<const uint32_t> traced_again)
      : rays(e.followed), retraced(traced_again) {
    const auto count = size_t(std::ranges::count_if(rays, &FollowedRay::has_hit));
    hits = e.hits.last(count);
  }
  KnownFollowed() = default;

  /// The next one, which is the element's k-th ray.
  FollowedPath next(size_t element, size_t k) {
    FollowedPath out{uint32_t(element), uint32_t(k), 0, rays.front(), {}};
    rays = rays.subspan(1);
    if (!out.brought.has_hit()) return out;
    out.hit = hits.front(), hits = hits.subspan(1);
    return out;
  }
  bool is_traced_again(size_t k) {
    while (!retraced.empty() && retraced.front() < k) retraced = retraced.subspan(1);
    return !retraced.empty() && retraced.front() == k;
  }
};

/// Ends of an element's rays, now and, where those are known, in the earlier bake.
struct ElementEnds {
  size_t element = 0;
  std::span<const RayEnd> now, then{};
  KnownFollowed known{};  ///< those of `then` that were followed on
};

/// Adds what an element's followed rays bring. `traced` begins with the first of buffers.followed
/// that is the element's own or a later one's.
void add_element(const RayScene& in, ElementEnds ends, std::span<const FollowedPath>& traced,
                 float& near_m, TracedHits& out, RayTile& tile, std::vector<StoredHit>& hits) {
  auto& [element, now, then, known] = ends;
  const auto after = [&ends](size_t k) {
    return std::min(next_followed(ends.now, k),
                    ends.then.empty() ? ends.now.size() : next_followed(ends.then, k));
  };
  for (size_t k = after(0); k < now.size(); k = after(k + 1)) {
    const bool was = !then.empty() && then[k] == RayEnd::followed;
    FollowedPath path{uint32_t(element), uint32_t(k), 0, {}, {}};
    if (was) path = known.next(element, k);
    const bool stays = was && !known.is_traced_again(k);
    if (was && !stays) note_change(in, path.brought, path.hit, -1, element, out);
    if (now[k] != RayEnd::followed) continue;
    if (!stays) {
      path.brought = {};  // unless it was dropped: drop_enclosed_paths()
      if (!traced.empty() && traced.front().element == element && traced.front().ray == k)
        path = traced.front(), traced = traced.subspan(1);
      if (path.brought.way().is_plain) near_m = std::max(near_m, path.first_m);
      note_change(in, path.brought, path.hit, 1, element, out);
    }
    add_light(path.brought, element, out);
    tile.followed.push_back(path.brought);
    if (path.brought.has_hit()) hits.push_back(path.hit);
  }
}

/// Each element's hits of both, in memory of just that size.
HitTile joined(const HitTile& a, const HitTile& b) {
  HitTile out;
  out.end.reserve(a.end.size()), out.entries.reserve(a.entries.size() + b.entries.size());
  for (size_t k = 0; k < a.end.size(); ++k) {
    for (const HitTile* part : {&a, &b}) {
      const auto begin = part->entries.begin();
      const auto first = k == 0 ? 0 : std::ptrdiff_t(part->end[k - 1]);
      out.entries.insert(out.entries.end(), begin + first, begin + std::ptrdiff_t(part->end[k]));
    }
    out.end.push_back(uint32_t(out.entries.size()));
  }
  return out;
}

}  // namespace

FollowedPath ended(const RayScene& in, const NearPath& path, TracedHits& out) {
  const bool alive = max_component(path.throughput) > 0, found = alive && path.hit.found();
  Rgb light = path.light;
  if (alive && !found) {
    const Rgb l = path.throughput * light::soft_radiance(in.scene, in.around, path.direction);
    add_sky(in.near->layers, l * weight_of(path), path.element, out);
    light += l;
  }
  const bool has_hit =
      found && (!path.hit.back_face ||
                scene::reflects_from_behind(scene::material_at(in.scene, path.hit.point())));
  const FollowedWay way{path.is_plain, alive ? path.direction : Vec3{}, has_hit, path.second_half};
  light = light * weight_of(path);
  FollowedPath end{path.element, path.ray, path.first_m, FollowedRay::pack(light, way), {}};
  if (!has_hit) return end;
  const uint32_t tint = pack_tint(path.throughput, hash64(path.seed, path.sample ^ 0x4e37u));
  end.hit = store(in, path.hit.point(), {tint, path.second_half, path.doublings},
                  transport::MayBeInside::yes);
  return end;
}

void drop_enclosed_paths(const RayScene& in, const transport::Elements& elements, size_t element,
                         const TracedHits& hits, NearBuffers& near) {
  if (near.paths.empty() || near.paths.back().element != element) return;
  if (transport::is_enclosed(in.scene, in.near->tracer, elements, element,
                             back_faces(hits, element)))
    std::erase_if(near.paths,
                  [element](const NearPath& p) { return p.element == element && p.hit.back_face; });
}

uint64_t follow_paths(const RayScene& in, RayBuffers& buffers, TracedHits& out) {
  if (buffers.near.paths.empty()) return 0;
  if (in.layers) buffers.near.by_layer = out.sky_by_layer;
  return follow_near(*in.near, buffers.near, [&](const NearPath& path) {
    buffers.followed.push_back(ended(in, path, out));
  });
}

uint64_t follow_on(const RayScene& in, size_t first, std::span<const uint32_t> ends_of,
                   const RetracedRays* retraced, RayBuffers& buffers, TracedHits& out,
                   RayTile& tile) {
  const uint64_t rays = follow_paths(in, buffers, out);
  std::ranges::sort(buffers.followed, {},
                    [](const FollowedPath& p) { return std::tuple(p.element, p.ray); });
  std::span<const FollowedPath> traced = buffers.followed;
  buffers.followed_hits.entries.clear(), buffers.followed_hits.end.clear();
  tile.near_m.assign(ends_of.size(), 0.0f);
  for (size_t k = 0; k < ends_of.size(); ++k) {
    const uint32_t begin = k == 0 ? 0 : ends_of[k - 1];
    ElementEnds ends{.element = first + k,
                     .now = std::span(tile.ends).subspan(begin, ends_of[k] - begin)};
    const EarlierElement* before = retraced ? retraced->of(k) : nullptr;
    if (before && !before->followed.empty()) {
      tile.near_m[k] = before->near_m, ends.then = before->ends;
      ends.known = KnownFollowed(*before, retraced->rays_of(k));
    }
    add_element(in, ends, traced, tile.near_m[k], out, tile, buffers.followed_hits.entries);
    buffers.followed_hits.end.push_back(uint32_t(buffers.followed_hits.entries.size()));
  }
  std::swap(tile.hits, buffers.other_hits);
  tile.hits = joined(buffers.other_hits, buffers.followed_hits);
  return rays;
}

}  // namespace luxel::gather
