#include "luxel/solve/gather/reuse/rays_again.h"

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

/// Sets work.marked where a ray's direction alone does not tell that it stays.
void mark_at_once(const AgainWorld& world, Vec3 origin, const EarlierElement& before,
                  RetraceWork& work) {
  const std::span<const RayEnd> ends = before.ends;
  if (!before.follows_again)
    mark_followed(world.earlier.boxes, origin, before.near_m, ends, before.followed, work.marked);
  else
    for (size_t k = next_followed(ends, 0); k < ends.size(); k = next_followed(ends, k + 1))
      work.marked[k] = 1;
  if (!world.tints) return;
  for (size_t k = 0; k < ends.size(); ++k)
    if (ends[k] == RayEnd::escaped) work.marked[k] = 1;
}

/// In which cells rays are that are marked.
uint64_t cells_of(std::span<const uint8_t> marked, const RayBatch& batch) {
  uint64_t out = 0;
  for (size_t k = next_marked(marked, 0); k < marked.size(); k = next_marked(marked, k + 1))
    out |= uint64_t(1) << batch.cell_of(uint32_t(k));
  return out;
}

}  // namespace

void choose_again(const AgainWorld& world, size_t element, Vec3 origin, uint64_t seed,
                  Samples samples, const EarlierElement& before, RetraceWork& work) {
  const Vec3 normal = world.elements.normal[element];
  const Vec3 geometric = world.elements.geometric_normal[element];
  const std::vector<Box3>& boxes = world.earlier.boxes;
  uint64_t cells = cells_towards(boxes, origin, normal, geometric, world.cell_cones);
  work.maybe.clear(), work.again.clear();
  work.marked.assign(samples.count(), 0);
  mark_at_once(world, origin, before, work);
  if (cells == 0 && next_marked(work.marked, 0) == work.marked.size()) return;
  find_ray_cells(seed, samples, work.batch);
  cells |= cells_of(work.marked, work.batch);
  fill_samples_of(cells, work.batch);
  for (; cells != 0; cells &= cells - 1) {
    const auto cell = size_t(std::countr_zero(cells));
    for (uint32_t k = work.batch.first_of_cell[cell]; k < work.batch.first_of_cell[cell + 1]; ++k)
      work.maybe.push_back(k);
  }
  fill_directions(origin, normal, geometric, work.maybe, work.batch);
  mark_rays(boxes, work.batch.rays, work.maybe, work.marked);
  for (const uint32_t k : work.maybe)
    if (work.marked[k]) work.again.push_back(k);
}

void clear(RaysAgain& rays) {
  rays.known.clear(), rays.is_known.clear(), rays.end.clear();
  rays.ray.clear(), rays.sample.clear(), rays.rays.clear();
}

void add_again(const EarlierElement* before, const RetraceWork& work, RaysAgain& out) {
  out.known.push_back(before ? *before : EarlierElement{});
  out.is_known.push_back(before ? 1 : 0);
  if (before)
    for (const uint32_t k : work.again) {
      out.ray.push_back(k), out.sample.push_back(work.batch.sample[k]);
      out.rays.push_back(work.batch.rays[k]);
    }
  out.end.push_back(uint32_t(out.ray.size()));
}

void trace_again(const trace::RayTracer& tracer, RaysAgain& rays) {
  rays.hits.resize(rays.rays.size());
  tracer.closest_hits(rays.rays, rays.hits);
  rays.tints.clear();
  if (!tracer.has_tints()) return;
  rays.tints.assign(rays.rays.size(), {1, 1, 1});
  tracer.tint(rays.rays, rays.hits, rays.tints);
}

void take_again(const RaysAgain& rays, size_t k, RetraceWork& work) {
  const EarlierElement& before = rays.known[k];
  const size_t count = before.ends.size();
  work.again.clear();
  work.hits.resize(count), work.batch.rays.resize(count), work.batch.sample.resize(count);
  if (!rays.tints.empty()) work.tint.assign(count, {1, 1, 1});
  for (uint32_t at = k == 0 ? 0 : rays.end[k - 1]; at < rays.end[k]; ++at) {
    const uint32_t ray = rays.ray[at];
    work.again.push_back(ray);
    work.hits[ray] = rays.hits[at], work.batch.rays[ray] = rays.rays[at];
    work.batch.sample[ray] = rays.sample[at];
    if (!rays.tints.empty()) work.tint[ray] = rays.tints[at];
  }
}

}  // namespace luxel::gather
