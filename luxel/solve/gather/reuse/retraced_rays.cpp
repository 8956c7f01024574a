#include "luxel/solve/gather/reuse/retraced_rays.h"

#include <algorithm>
#include <bit>

namespace luxel::gather {

bool EarlierCursor::advance(size_t k, size_t count, bool knows_escaped) {
  if (next_ray + count > tile->ends.size()) return false;
  const uint32_t first = k == 0 ? 0 : tile->hits.end[k - 1];
  const auto ends = std::span(tile->ends).subspan(next_ray, count);
  of = {ends,
        std::span(tile->hits.entries).subspan(first, tile->hits.end[k] - first),
        knows_escaped ? &tile->escaped[k] : nullptr,
        std::span(tile->followed).subspan(next_followed, count_of(ends, RayEnd::followed)),
        tile->near_m[k],
        true};
  next_ray += count, next_followed += of.followed.size();
  const auto with_hit = size_t(std::ranges::count_if(of.followed, &FollowedRay::has_hit));
  return count_of(ends, RayEnd::hit) + count_of(ends, RayEnd::behind) + with_hit == of.hits.size();
}

namespace {

/// The first ray from `from` on that is marked; marked.size() where there is none.
size_t next_marked(std::span<const uint8_t> marked, size_t from) {
  return next_of(std::as_bytes(marked), 1, from);
}

/// Sets buffers.marked where a hit may be read elsewhere now: a wall near it has come or gone. Hits
/// of rays that were followed on come after all others.
void mark_doubtful(std::span<const uint64_t> doubtful, const EarlierElement& before,
                   std::span<uint8_t> marked) {
  if (doubtful.empty()) return;
  const auto is_doubtful = [&](StoredHit hit) {
    return doubtful[hit.base() / 64] >> (hit.base() % 64) & 1;
  };
  size_t hit = 0;
  for (size_t k = 0; k < before.ends.size(); ++k)
    if (before.ends[k] == RayEnd::hit || before.ends[k] == RayEnd::behind)
      if (is_doubtful(before.hits[hit++])) marked[k] = 1;
  auto next = before.followed.begin();
  for (size_t k = next_followed(before.ends, 0); k < before.ends.size();
       k = next_followed(before.ends, k + 1))
    if ((next++)->has_hit() && is_doubtful(before.hits[hit++])) marked[k] = 1;
}

/// Sets buffers.marked where a ray's direction alone does not tell that it stays.
void mark_at_once(const RetraceScene& in, Vec3 origin, const EarlierElement& before,
                  RetraceBuffers& buffers) {
  const std::span<const RayEnd> ends = before.ends;
  if (!before.follows_again)
    mark_followed(in.earlier.boxes, origin, before.near_m, ends, before.followed, buffers.marked);
  else
    for (size_t k = next_followed(ends, 0); k < ends.size(); k = next_followed(ends, k + 1))
      buffers.marked[k] = 1;
  if (!in.tints) return;
  for (size_t k = 0; k < ends.size(); ++k)
    if (ends[k] == RayEnd::escaped) buffers.marked[k] = 1;
}

/// In which cells rays are that are marked.
uint64_t cells_of(std::span<const uint8_t> marked, const RayBatch& batch) {
  uint64_t out = 0;
  for (size_t k = next_marked(marked, 0); k < marked.size(); k = next_marked(marked, k + 1))
    out |= uint64_t(1) << batch.cell_of(uint32_t(k));
  return out;
}

}  // namespace

void choose_retraced(const RetraceScene& in, size_t element, Vec3 origin, uint64_t seed,
                     Samples samples, const EarlierElement& before, RetraceBuffers& buffers) {
  const Vec3 normal = in.elements.normal[element];
  const Vec3 geometric = in.elements.geometric_normal[element];
  const std::vector<Box3>& boxes = in.earlier.boxes;
  uint64_t cells = cells_towards(boxes, origin, normal, geometric, in.cell_cones);
  buffers.maybe.clear(), buffers.retraced.clear();
  buffers.marked.assign(samples.count(), 0);
  mark_at_once(in, origin, before, buffers);
  mark_doubtful(in.doubtful, before, buffers.marked);
  if (cells == 0 && next_marked(buffers.marked, 0) == buffers.marked.size()) return;
  find_ray_cells(seed, samples, buffers.batch);
  cells |= cells_of(buffers.marked, buffers.batch);
  fill_samples_of(cells, buffers.batch);
  for (; cells != 0; cells &= cells - 1) {
    const auto cell = size_t(std::countr_zero(cells));
    for (uint32_t k = buffers.batch.first_of_cell[cell]; k < buffers.batch.first_of_cell[cell + 1];
         ++k)
      buffers.maybe.push_back(k);
  }
  fill_directions(origin, normal, geometric, buffers.maybe, buffers.batch);
  mark_rays(boxes, buffers.batch.rays, buffers.maybe, buffers.marked);
  for (const uint32_t k : buffers.maybe)
    if (buffers.marked[k]) buffers.retraced.push_back(k);
}

void clear(RetracedRays& rays) {
  rays.known.clear(), rays.is_known.clear(), rays.end.clear();
  rays.ray.clear(), rays.sample.clear(), rays.rays.clear();
}

void add_retraced(const EarlierElement* before, const RetraceBuffers& buffers, RetracedRays& out) {
  out.known.push_back(before ? *before : EarlierElement{});
  out.is_known.push_back(before ? 1 : 0);
  if (before)
    for (const uint32_t k : buffers.retraced) {
      out.ray.push_back(k), out.sample.push_back(buffers.batch.sample[k]);
      out.rays.push_back(buffers.batch.rays[k]);
    }
  out.end.push_back(uint32_t(out.ray.size()));
}

void retrace(const trace::RayTracer& tracer, RetracedRays& rays) {
  rays.hits.resize(rays.rays.size());
  tracer.closest_hits(rays.rays, rays.hits);
  rays.tints.clear();
  if (!tracer.has_tints()) return;
  rays.tints.assign(rays.rays.size(), {1, 1, 1});
  tracer.tint(rays.rays, rays.hits, rays.tints);
}

void take_retraced(const RetracedRays& rays, size_t k, RetraceBuffers& buffers) {
  const EarlierElement& before = rays.known[k];
  const size_t count = before.ends.size();
  buffers.retraced.clear();
  buffers.hits.resize(count), buffers.batch.rays.resize(count), buffers.batch.sample.resize(count);
  if (!rays.tints.empty()) buffers.tint.assign(count, {1, 1, 1});
  for (uint32_t at = k == 0 ? 0 : rays.end[k - 1]; at < rays.end[k]; ++at) {
    const uint32_t ray = rays.ray[at];
    buffers.retraced.push_back(ray);
    buffers.hits[ray] = rays.hits[at], buffers.batch.rays[ray] = rays.rays[at];
    buffers.batch.sample[ray] = rays.sample[at];
    if (!rays.tints.empty()) buffers.tint[ray] = rays.tints[at];
  }
}

}  // namespace luxel::gather
