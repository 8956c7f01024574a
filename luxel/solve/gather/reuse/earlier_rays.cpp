#include "luxel/solve/gather/reuse/earlier_rays.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/bytes.h"

namespace luxel::gather {
namespace {

bool is_sound(const RayTile& rays, uint32_t places) {
  // The greatest of all instead of the first that is wrong, which takes a branch for each.
  uint8_t end = 0;
  for (const RayEnd e : rays.ends) end = std::max(end, uint8_t(e));
  StoredHit farthest;
  for (const StoredHit& hit : rays.hits.entries) farthest.bits = std::max(farthest.bits, hit.bits);
  return end <= uint8_t(RayEnd::followed) && farthest.base() < places &&
         count_of(rays.ends, RayEnd::followed) == rays.followed.size() &&
         std::ranges::is_sorted(rays.hits.end);
}

/// The half-line meets the box.
bool meets(const Box3& box, Vec3 from, Vec3 direction) {
  float begin = 0, end = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const float d = direction[axis];
    const float below = box.lower[axis] - from[axis], above = box.upper[axis] - from[axis];
    if (d == 0) {
      if (below > 0 || above < 0) return false;
      continue;
    }
    const float a = below / d, b = above / d;
    begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
  }
  return begin <= end;
}

/// Directions from a place to a ball around a box; nothing: the place lies in it, and all do. A bit
/// more than that, for directions that are unit but for rounding.
std::optional<Cone> cone_to(const Box3& box, Vec3 from) {
  const Vec3 to = box.centre() - from;
  const float distance = length(to), radius = 0.5f * box.diagonal();
  if (distance <= radius) return std::nullopt;
  const float sine = radius / distance;
  return Cone{to / distance,
              std::sqrt((distance - radius) * (distance + radius)) / distance - 1e-4f, sine};
}

}  // namespace

std::optional<std::vector<std::vector<uint16_t>>> earlier_rounds(const RecordFile& file,
                                                                 size_t elements) {
  std::vector<std::vector<uint16_t>> rounds;
  while (true) {
    const auto bytes = file.read_whole({rounds.size(), kSamplesPart});
    if (!bytes) break;
    std::vector<uint16_t> samples(elements);
    ByteReader in{*bytes};
    in.get(std::span(samples));
    if (!in.ended_well()) return std::nullopt;
    rounds.push_back(std::move(samples));
  }
  if (rounds.empty()) return std::nullopt;
  return rounds;
}

const RayTile* find_rays(const RecordFile& file, uint64_t round, uint64_t tile, size_t elements,
                         uint32_t places, RayTileBuffer& buffer) {
  if (!file.read_whole({round, tile}, buffer.bytes)) return nullptr;
  ByteReader in{buffer.bytes};
  RayTile& out = buffer.rays;
  out.hits.end.resize(elements), out.escaped.resize(elements), out.near_m.resize(elements);
  in.get(std::span(out.hits.end)), in.get(std::span(out.escaped)), in.get(std::span(out.near_m));
  const uint64_t rays = in.get_value<uint64_t>(), followed = in.get_value<uint64_t>();
  // Each for itself first: their sum could wrap around.
  if (!in.ok || rays > in.bytes.size() || followed > rays ||
      in.bytes.size() - rays !=
          followed * sizeof(FollowedRay) + size_t(out.hits.end.back()) * sizeof(StoredHit))
    return nullptr;
  out.ends.resize(rays), out.followed.resize(followed);
  out.hits.entries.resize(out.hits.end.back());
  in.get(std::span(out.ends)), in.get(std::span(out.followed)), in.get(std::span(out.hits.entries));
  return is_sound(out, places) ? &out : nullptr;
}

void keep_rays(PartStore* store, uint64_t round, uint64_t tile, const RayTile& rays) {
  const KeptStage kept{store, round};
  if (!kept.wants()) return;
  ByteWriter out;
  const size_t per_element = sizeof(rays.hits.end[0]) + sizeof(EscapedLight) + sizeof(float);
  out.bytes.reserve(rays.hits.end.size() * per_element + 2 * sizeof(uint64_t) + rays.ends.size() +
                    rays.followed.size() * sizeof(FollowedRay) +
                    rays.hits.entries.size() * sizeof(StoredHit));
  out.put(std::span(rays.hits.end)), out.put(std::span(rays.escaped));
  out.put(std::span(rays.near_m));
  out.put_value(uint64_t(rays.ends.size())), out.put_value(uint64_t(rays.followed.size()));
  out.put(std::span(rays.ends)), out.put(std::span(rays.followed));
  out.put(std::span(rays.hits.entries));
  kept.keep(tile, out.bytes);
}

void keep_samples(PartStore* store, uint64_t round, std::span<const uint16_t> samples) {
  KeptStage{store, round}.keep(kSamplesPart, std::as_bytes(samples));
}

void mark_rays(std::span<const Box3> boxes, std::span<const trace::Ray> rays,
               std::span<const uint32_t> which, std::span<uint8_t> retraced) {
  if (which.empty()) return;
  for (const Box3& box : boxes) {
    const std::optional<Cone> cone = cone_to(box, rays[which[0]].origin);
    for (const uint32_t k : which)
      if ((!cone || dot(cone->axis, rays[k].direction) >= cone->cosine) &&
          meets(box, rays[k].origin, rays[k].direction))
        retraced[k] = 1;
  }
}

void mark_followed(std::span<const Box3> boxes, Vec3 from, float near_m,
                   std::span<const RayEnd> ends, std::span<const FollowedRay> followed,
                   std::span<uint8_t> retraced) {
  // A way that starts within near_m and meets a box leads in the same direction from `from` into
  // the box grown by as much; and by what is not known of the direction.
  const auto may_meet = [&](const Box3& box, Vec3 direction) {
    const float farthest_m = length(box.centre() - from) + box.diagonal();
    const float r = near_m + 2 * kWayError * farthest_m;
    return meets({box.lower - Vec3{r, r, r}, box.upper + Vec3{r, r, r}}, from, direction);
  };
  auto next = followed.begin();
  for (size_t k = next_followed(ends, 0); k < ends.size(); k = next_followed(ends, k + 1)) {
    const FollowedWay way = (next++)->way();
    if (!way.is_plain ||
        std::ranges::any_of(boxes, [&](const Box3& box) { return may_meet(box, way.direction); }))
      retraced[k] = 1;
  }
}

uint64_t cells_towards(std::span<const Box3> boxes, Vec3 from, Vec3 normal, Vec3 geometric_normal,
                       const CellCones& cells) {
  static_assert(kCells == 64);
  const Frame frame = frame_around(normal);
  uint64_t out = 0;
  const auto add = [&](Cone cone) {
    cone.axis = {dot(frame.tangent, cone.axis), dot(frame.bitangent, cone.axis),
                 dot(frame.normal, cone.axis)};
    out |= cells_that_meet(cells, cone);
  };
  const bool bent = !(normal == geometric_normal);
  for (const Box3& box : boxes) {
    std::optional<Cone> cone = cone_to(box, from);
    if (!cone) return ~uint64_t(0);
    add(*cone);
    if (!bent) continue;
    // A mirrored ray meets the box where the ray itself would meet its image.
    cone->axis = cone->axis - geometric_normal * (2 * dot(cone->axis, geometric_normal));
    add(*cone);
  }
  return out;
}

}  // namespace luxel::gather
