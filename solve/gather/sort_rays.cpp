#include "solve/gather/sort_rays.h"

#include <algorithm>

#include "base/check.h"
#include "base/random.h"

namespace luxel::gather {
namespace {

/// Adds radiance that a ray has brought without the map.
void add_light(Rgb l, bool second_half, size_t element, TracedHits& out) {
  out.sky[element] += l;
  out.sky_luminance2[element] += luminance(l) * luminance(l);
  out.sky_first_less_second[element] += second_half ? -luminance(l) : luminance(l);
}

/// Radiance of a ray that has left the scene.
void add_sky(const RayWorld& world, Rgb l, size_t element, TracedHits& out) {
  if (world.layers && world.layers->of_surroundings)
    out.sky_by_layer[element * world.layers->size() + *world.layers->of_surroundings] += l;
}

/// Counts `rays` rays of an element that end alike.
void count_ends(RayEnd end, int rays, size_t element, TracedHits& out) {
  const auto add = [&](uint16_t& counter) { counter = uint16_t(int(counter) + rays); };
  if (end == RayEnd::back) add(out.met_back[element]);
  if (end == RayEnd::behind) add(out.met_double_sided_back[element]);
  if (end == RayEnd::escaped) add(out.escaped[element]);
}

bool is_hit(RayEnd end) { return end == RayEnd::hit || end == RayEnd::behind; }

/// What rays of the batch see outside, in `light`, without what they have passed.
void look_outside(const RayWorld& world, const RayBatch& batch, OutsideLook& look) {
  look.directions.clear();
  for (const uint32_t k : look.rays) look.directions.push_back(batch.rays[k].direction);
  transport::soft_radiance(world.scene, world.around, look.directions, look.light);
}

/// Light of the batch's escaped rays, all of which have a direction.
EscapedLight escaped_light(const RayWorld& world, RayWork& work, Samples samples,
                           std::span<const RayEnd> ends) {
  OutsideLook& look = work.outside;
  look.rays.clear();
  for (uint32_t k = 0; k < ends.size(); ++k)
    if (ends[k] == RayEnd::escaped) look.rays.push_back(k);
  look_outside(world, work.batch, look);
  EscapedLight out;
  for (size_t at = 0; at < look.rays.size(); ++at) {
    const uint32_t k = look.rays[at];
    const Rgb l = work.tint.empty() ? look.light[at] : look.light[at] * work.tint[k];
    out.add(l, samples.in_second_half(work.batch.sample[k]));
  }
  return out;
}

/// The same from what was known: what was traced again no longer brings what it brought.
EscapedLight escaped_light(const RayWorld& world, RayWork& work, Samples samples,
                           const EarlierElement& before, std::span<const RayEnd> ends) {
  if (!before.escaped) return escaped_light(world, work, samples, ends);
  OutsideLook& look = work.outside;
  look.rays = work.again;
  look_outside(world, work.batch, look);
  EscapedLight out = *before.escaped;
  for (size_t at = 0; at < look.rays.size(); ++at) {
    const uint32_t k = look.rays[at];
    const Rgb l = look.light[at];
    const bool second_half = samples.in_second_half(work.batch.sample[k]);
    if (before.ends[k] == RayEnd::escaped) out.take_away(l, second_half);
    if (ends[k] == RayEnd::escaped) out.add(work.tint.empty() ? l : l * work.tint[k], second_half);
  }
  out.sum = max(out.sum, Rgb{}), out.luminance2 = std::max(out.luminance2, 0.0f);
  return out;
}

/// Notes the light of the element's escaped rays.
void add_escaped(const RayWorld& world, const EscapedLight& light, size_t element, TracedHits& out,
                 RayTile& tile) {
  tile.escaped.push_back(light);
  out.sky[element] += light.sum, out.sky_luminance2[element] += light.luminance2;
  out.sky_first_less_second[element] += luminance(light.sum) - 2 * light.second_luminance;
  add_sky(world, light.sum, element, out);
}

/// How the batch's k-th ray has ended; one to be followed on is added to work.near.paths.
RayEnd end_of(const RayWorld& world, RayWork& work, size_t k) {
  const trace::Hit& hit = work.hits[k];
  if (!hit.found()) return RayEnd::escaped;
  if (hit.back_face && !scene::reflects_from_behind(scene::material_at(world.scene, hit.point())))
    return RayEnd::back;
  if (world.near != nullptr) {
    NearPath path;
    path.sample = work.batch.sample[k], path.ray = uint32_t(k);
    if (!work.tint.empty()) path.throughput = work.tint[k];
    path.hit = hit, path.first_m = hit.t, path.is_plain = !hit.back_face;
    if (goes_on(*world.near, path)) {
      work.near.paths.push_back(path);
      return RayEnd::followed;
    }
  }
  return hit.back_face ? RayEnd::behind : RayEnd::hit;
}

/// Counts the end of a ray that was traced, and keeps its hit.
void take_traced(const RayWorld& world, const RayWork& work, size_t k, RayEnd end, size_t element,
                 Samples samples, TracedHits& out, RayTile& tile) {
  if (end == RayEnd::followed) {
    if (work.near.paths.back().hit.back_face) ++out.met_double_sided_back[element];
    return;
  }
  count_ends(end, 1, element, out);
  if (!is_hit(end)) return;
  const uint32_t sample = work.batch.sample[k];
  const uint32_t tint =
      work.tint.empty() ? kNoTint : pack_tint(work.tint[k], hash64(element, sample ^ 0x7147u));
  tile.hits.entries.push_back(
      store(world.atlas, work.hits[k].point(), {tint, samples.in_second_half(sample)}));
}

/// A hit that an element's rays have won (1) or lost (-1).
void note_change(const RayWorld& world, StoredHit hit, float sign, size_t element,
                 TracedHits& out) {
  if (!world.sent) return;
  const Float4 b = lookup(*world.sent, hit);
  out.change[element] += Rgb{b[0], b[1], b[2]} * sign;
}

/// The same of a ray that was followed on. `hit` is its own, if it has one.
void note_change(const RayWorld& world, const FollowedRay& ray, StoredHit hit, float sign,
                 size_t element, TracedHits& out) {
  if (!world.sent) return;
  out.change[element] += ray.light * (sign * kPi);
  if (ray.has_hit()) note_change(world, hit, sign, element, out);
}

}  // namespace

StoredHit store(const atlas::Atlas& atlas, const scene::SurfacePoint& p, StoredHit::Ray ray) {
  const auto& corners = atlas.corners[atlas.triangle_number(p.instance, p.triangle)];
  const Vec2 at = interpolate(corners[0], corners[1], corners[2], p.at);
  const float limit = float(atlas.resolution);
  const float x = std::clamp(at.x, 0.0f, limit) + 0.5f, y = std::clamp(at.y, 0.0f, limit) + 0.5f;
  const uint32_t x0 = uint32_t(x), y0 = uint32_t(y);  // with the border of one texel
  constexpr float kSteps = float(StoredHit::kSteps);
  return StoredHit::pack(y0 * uint32_t(atlas.resolution + 2) + x0,
                         uint32_t((x - float(x0)) * kSteps + 0.5f),
                         uint32_t((y - float(y0)) * kSteps + 0.5f), ray);
}

void sort_rays(const RayWorld& world, RayWork& work, size_t element, Samples samples,
               TracedHits& out, RayTile& tile) {
  const size_t count = work.batch.rays.size();
  for (size_t k = 0; k < count; ++k) {
    const RayEnd end = end_of(world, work, k);
    tile.ends.push_back(end);
    take_traced(world, work, k, end, element, samples, out, tile);
  }
  const std::span<const RayEnd> ends = std::span(tile.ends).last(count);
  add_escaped(world, escaped_light(world, work, samples, ends), element, out, tile);
}

void merge_rays(const RayWorld& world, RayWork& work, size_t element, Samples samples,
                const EarlierElement& before, TracedHits& out, RayTile& tile) {
  const size_t count = before.ends.size();
  LUXEL_CHECK(count == samples.count());
  tile.ends.insert(tile.ends.end(), before.ends.begin(), before.ends.end());
  const std::span<RayEnd> ends = std::span(tile.ends).last(count);
  for (const RayEnd end : {RayEnd::back, RayEnd::behind, RayEnd::escaped})
    count_ends(end, int(count_of(before.ends, end)), element, out);
  size_t next = 0, hit = 0;
  // The hits of rays from `next` on, up to `end`, stay.
  const auto keep_up_to = [&](size_t end) {
    const std::span<const RayEnd> kept = before.ends.subspan(next, end - next);
    const size_t stay = count_of(kept, RayEnd::hit) + count_of(kept, RayEnd::behind);
    const auto from = before.hits.begin() + std::ptrdiff_t(hit);
    tile.hits.entries.insert(tile.hits.entries.end(), from, from + std::ptrdiff_t(stay));
    next = end, hit += stay;
  };
  for (const uint32_t k : work.again) {
    keep_up_to(k);
    const RayEnd known = before.ends[k];
    count_ends(known, -1, element, out);
    if (is_hit(known)) note_change(world, before.hits[hit++], -1, element, out);
    ends[k] = end_of(world, work, k);
    take_traced(world, work, k, ends[k], element, samples, out, tile);
    if (is_hit(ends[k])) note_change(world, tile.hits.entries.back(), 1, element, out);
    next = k + 1;
  }
  keep_up_to(count);
  const EscapedLight escaped = escaped_light(world, work, samples, before, ends);
  if (world.sent && before.escaped)
    out.change[element] += (escaped.sum - before.escaped->sum) * kPi;
  add_escaped(world, escaped, element, out, tile);
}

namespace {

/// Takes work.near.paths to where they end, into work.followed, in the order of rays.
uint64_t follow_paths(const RayWorld& world, RayWork& work, size_t element, Samples samples,
                      uint64_t seed, TracedHits& out) {
  work.followed.clear();
  if (work.near.paths.empty()) return 0;
  if (world.layers)
    work.near.by_layer =
        std::span(out.sky_by_layer).subspan(element * world.layers->size(), world.layers->size());
  const uint64_t rays = follow_near(*world.near, seed, work.near, [&](const NearPath& path) {
    const bool second_half = samples.in_second_half(path.sample);
    const bool alive = max_component(path.throughput) > 0, found = alive && path.hit.found();
    Rgb light = path.light;
    if (alive && !found) {
      const Rgb l =
          path.throughput * transport::soft_radiance(world.scene, world.around, path.direction);
      add_sky(world, l, element, out);
      light += l;
    }
    const bool has_hit =
        found && (!path.hit.back_face ||
                  scene::reflects_from_behind(scene::material_at(world.scene, path.hit.point())));
    const FollowedWay way{path.is_plain, alive ? path.direction : Vec3{}, has_hit, second_half};
    FollowedPath end{path.ray, path.first_m, FollowedRay::pack(light, way), {}};
    if (has_hit)
      end.hit =
          store(world.atlas, path.hit.point(),
                {pack_tint(path.throughput, hash64(seed, path.sample ^ 0x4e37u)), second_half});
    work.followed.push_back(end);
  });
  std::ranges::sort(work.followed, {}, &FollowedPath::ray);
  return rays;
}

void add_followed(const FollowedPath& path, size_t element, TracedHits& out, RayTile& tile) {
  tile.followed.push_back(path.brought);
  add_light(path.brought.light, path.brought.way().second_half, element, out);
  if (path.brought.has_hit()) tile.hits.entries.push_back(path.hit);
}

}  // namespace

uint64_t follow_on(const RayWorld& world, RayWork& work, size_t element, Samples samples,
                   uint64_t seed, const EarlierElement* before, TracedHits& out, RayTile& tile) {
  const uint64_t rays = follow_paths(world, work, element, samples, seed, out);
  const std::span<const RayEnd> ends = std::span(tile.ends).last(samples.count());
  float& near_m = tile.near_m.emplace_back();
  std::span<const FollowedRay> known = before ? before->followed : std::span<const FollowedRay>{};
  const auto known_hits = size_t(std::ranges::count_if(known, &FollowedRay::has_hit));
  auto known_hit = before ? before->hits.end() - std::ptrdiff_t(known_hits)
                          : std::span<const StoredHit>::iterator{};
  if (!known.empty()) near_m = before->near_m;
  const std::span<const RayEnd> known_ends = known.empty() ? ends : before->ends;
  const auto after = [&](size_t k) {
    return std::min(next_followed(ends, k), next_followed(known_ends, k));
  };
  auto next = work.followed.begin();
  for (size_t k = after(0); k < ends.size(); k = after(k + 1)) {
    const bool was = !known.empty() && known_ends[k] == RayEnd::followed;
    const FollowedRay old = was ? known.front() : FollowedRay{};
    const StoredHit old_hit = old.has_hit() ? *known_hit++ : StoredHit{};
    if (was) known = known.subspan(1);
    const bool stays = was && !work.marked[k];
    if (was && !stays) note_change(world, old, old_hit, -1, element, out);
    if (ends[k] != RayEnd::followed) continue;
    FollowedPath path{uint32_t(k), 0, old, old_hit};
    if (!stays) path.brought = {};  // where it was dropped: see Round::drop_enclosed_paths()
    if (!stays && next != work.followed.end() && next->ray == k) path = *next++;
    if (path.brought.way().is_plain) near_m = std::max(near_m, path.first_m);
    if (!stays) note_change(world, path.brought, path.hit, 1, element, out);
    add_followed(path, element, out, tile);
  }
  return rays;
}

}  // namespace luxel::gather
