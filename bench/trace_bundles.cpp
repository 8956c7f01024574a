// Making and tracing bundles.
#include <algorithm>

#include "bench/bundles.h"
#include "luxel/base/parallel.h"
#include "luxel/light/surroundings.h"

namespace luxel::bench {
namespace {

/// 16 rays, a packet or two, have texels of a square of 4 x 4 of their set.
constexpr uint32_t kBundleSide = 16 * kSetSide;
static_assert(kBundleSide * kBundleSide / kSets == kParallelRays);
/// So many directions of a bundle are traced before their hits are looked at: they stay in a core's
/// cache.
constexpr size_t kDirectionsAtATime = 64;

/// Every second bit of the result.
uint32_t spread_bits(uint32_t v) {
  v = (v | v << 4) & 0x0f0f;
  v = (v | v << 2) & 0x3333;
  return (v | v << 1) & 0x5555;
}

/// Texels are sorted by chart, square, set and place.
using BundleKey = std::array<uint32_t, 4>;

BundleKey key_of(const validate::Prepared& p, const atlas::Texel& t) {
  const uint32_t squares = uint32_t(p.atlas.resolution) / kBundleSide + 1;
  const uint32_t x = t.x % kBundleSide / kSetSide, y = t.y % kBundleSide / kSetSide;
  return {p.atlas.chart[t.triangle_number], t.y / kBundleSide * squares + t.x / kBundleSide,
          t.y % kSetSide * kSetSide + t.x % kSetSide, spread_bits(x) | spread_bits(y) << 1};
}

bool has_one_normal(const transport::Elements& elements, std::span<const uint32_t> which) {
  constexpr float kFar = 1e-4f;
  const Vec3 n = elements.normal[which[0]];
  return std::ranges::all_of(which, [&](uint32_t i) {
    return length(elements.normal[i] - n) < kFar && length(elements.geometric_normal[i] - n) < kFar;
  });
}

std::span<const uint32_t> texels_of(const Bundles& all, const Bundle& bundle) {
  return std::span(all.element).subspan(bundle.first, bundle.end - bundle.first);
}

/// Every bundle looks at all groups of triangles, and shares what it finds among its rays.
bool is_projected(const BundleTrace& in, const Bundle& bundle) {
  const size_t rays = bundle.end - bundle.first;
  return bundle.is_flat && rays >= 8 && rays >= in.triangles.groups.size() / 2;
}

struct BundleBuffers {
  std::vector<Vec3> origins;
  std::vector<Frame> frames;
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> traced;
  std::vector<trace::Hit> hits;  ///< texel after texel, as gather looks at them
  ParallelBuffers parallel;
};

void trace_by_embree(const BundleTrace& in, std::span<const uint32_t> texels,
                     std::span<const Vec3> directions, BundleBuffers& b) {
  const size_t count = texels.size();
  b.rays.resize(directions.size() * count), b.traced.resize(b.rays.size());
  for (size_t k = 0; k < directions.size(); ++k)
    for (size_t j = 0; j < count; ++j) {
      Vec3 d = b.frames[j].to_world(directions[k]);
      const Vec3 horizon = in.p.elements.geometric_normal[texels[j]];
      if (!(horizon == b.frames[j].normal)) d = light::mirrored_above(d, horizon);
      b.rays[k * count + j] = {b.origins[j], 0, d, INFINITY};
    }
  in.p.tracer->closest_hits(b.rays, b.traced, trace::Packets::bundles);
  for (size_t k = 0; k < directions.size(); ++k)
    for (size_t j = 0; j < count; ++j) b.hits[j * kDirectionsAtATime + k] = b.traced[k * count + j];
}

void trace_bundle(const BundleTrace& in, std::span<const uint32_t> texels, const Bundle& bundle,
                  bool projects, BundleBuffers& b) {
  b.hits.resize(texels.size() * kDirectionsAtATime);
  b.frames.clear(), b.origins.clear();
  for (const uint32_t i : texels) {
    b.origins.push_back(in.p.elements.position[i]);
    b.frames.push_back(frame_around(in.p.elements.normal[i]));
  }
  RayStarts starts;
  if (projects) starts = ray_starts(b.origins);
  std::span<const Vec3> directions = in.directions[bundle.set];
  while (!directions.empty()) {
    const auto some = directions.first(std::min(kDirectionsAtATime, directions.size()));
    directions = directions.subspan(some.size());
    if (!projects) trace_by_embree(in, texels, some, b);
    for (size_t k = 0; projects && k < some.size(); ++k)
      parallel_hits(in.triangles, starts, b.frames[0].to_world(some[k]), b.parallel,
                    b.hits.data() + k, kDirectionsAtATime);
  }
}

}  // namespace

Bundles make_bundles(const validate::Prepared& p, std::span<const uint32_t> texels) {
  std::vector<BundleKey> keys(p.map.texels.size());
  for (const uint32_t i : texels) keys[i] = key_of(p, p.map.texels[i]);
  Bundles out;
  out.element.assign(texels.begin(), texels.end());
  std::ranges::sort(out.element, {}, [&](uint32_t i) { return keys[i]; });
  const auto belong_together = [&](uint32_t a, uint32_t b) {
    return std::equal(keys[a].begin(), keys[a].begin() + 3, keys[b].begin());
  };
  for (uint32_t first = 0; first < out.element.size();) {
    uint32_t end = first + 1;
    while (end < out.element.size() && belong_together(out.element[first], out.element[end])) ++end;
    Bundle bundle{first, end, keys[out.element[first]][2]};
    bundle.is_flat = has_one_normal(p.elements, texels_of(out, bundle));
    out.bundles.push_back(bundle);
    first = end;
  }
  return out;
}

BundleTrace bundle_trace(const validate::Prepared& p, uint32_t samples) {
  BundleTrace out{p, samples};
  out.triangles = triangle_groups(p.scene);
  gather::RayBatch batch;
  for (uint32_t set = 0; set < kSets; ++set) {
    gather::fill_rays({}, {0, 0, 1}, {0, 0, 1}, gather::seed_of_rays(1, set), {0, samples}, batch);
    std::vector<Vec3>& directions = out.directions.emplace_back();
    for (const trace::Ray& ray : batch.rays) directions.push_back(ray.direction);
  }
  return out;
}

void trace_as_gather(const BundleTrace& in, std::span<const uint32_t> elements,
                     trace::Packets packets) {
  const transport::Elements& e = in.p.elements;
  parallel_for(elements.size(), 256, [&](size_t begin, size_t end) {
    gather::RayBatch batch;
    std::vector<trace::Hit> hits(in.samples);
    for (const uint32_t i : elements.subspan(begin, end - begin)) {
      gather::fill_rays(e.position[i], e.normal[i], e.geometric_normal[i],
                        gather::seed_of_rays(1, i), {0, in.samples}, batch);
      in.p.tracer->closest_hits(batch.rays, hits, packets);
    }
  });
}

void trace_bundles(const BundleTrace& in, const Bundles& bundles, BundleTracer by) {
  parallel_for(bundles.bundles.size(), 8, [&](size_t begin, size_t end) {
    BundleBuffers buffers;
    for (const Bundle& bundle : std::span(bundles.bundles).subspan(begin, end - begin))
      trace_bundle(in, texels_of(bundles, bundle), bundle,
                   by == BundleTracer::projection && is_projected(in, bundle), buffers);
  });
}

double share_that_differs(const BundleTrace& in, const Bundles& bundles) {
  constexpr size_t kStride = 16;
  constexpr float kFar_m = 1e-3f;
  BundleBuffers projected, traced;
  double rays = 0, differ = 0;
  for (size_t n = 0; n < bundles.bundles.size(); n += kStride) {
    const Bundle& bundle = bundles.bundles[n];
    if (!is_projected(in, bundle)) continue;
    trace_bundle(in, texels_of(bundles, bundle), bundle, true, projected);
    trace_bundle(in, texels_of(bundles, bundle), bundle, false, traced);
    for (size_t k = 0; k < traced.hits.size(); ++k) {
      const trace::Hit &a = projected.hits[k], &b = traced.hits[k];
      rays += 1;
      differ += a.found() != b.found() || (a.found() && std::abs(a.t - b.t) > kFar_m);
    }
  }
  return rays > 0 ? differ / rays : 0;
}

}  // namespace luxel::bench
