// RayTracer over Embree 3. [Wald14]
#include "luxel/trace/ray_tracer.h"

#include <algorithm>
#include <array>

#include "luxel/base/check.h"
#include "luxel/trace/embree/embree_query.h"
#include "luxel/trace/embree/embree_scene.h"

namespace luxel::trace {
namespace {

/// Packets take Embree's hybrid traversal. The one for packets declared coherent is up to twice as
/// fast where the rays of a packet stay together, but loops for ever now and then in Embree 3.13.5
/// with instances (seen in rtcOccluded16), so it is only used for closest hits without them.
RTCIntersectContext packet_context(bool coherent = false) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

/// Packets of as many rays as a vector of the processor has numbers.
struct Packet8 {
  static constexpr unsigned kRays = 8;
  using Rays = RTCRay8;
  using Hits = RTCRayHit8;
  static constexpr auto intersect = rtcIntersect8;
  static constexpr auto occluded = rtcOccluded8;
};
struct Packet16 {
  static constexpr unsigned kRays = 16;
  using Rays = RTCRay16;
  using Hits = RTCRayHit16;
  static constexpr auto intersect = rtcIntersect16;
  static constexpr auto occluded = rtcOccluded16;
};

/// Calls work(P{}) with the packets of the processor.
template <class Work>
void with_packets(bool has_wide_vectors, const Work& work) {
  if (has_wide_vectors)
    work(Packet16{});
  else
    work(Packet8{});
}

/// Sets the fields that are the same for all rays, packet after packet.
template <class P>
void begin_packets(typename P::Rays& out) {
  for (unsigned i = 0; i < P::kRays; ++i)
    out.time[i] = 0, out.mask[i] = ~0u, out.id[i] = i, out.flags[i] = 0;
}

/// Compilers make vector code of it.
template <class P>
void load_rays(const Ray* from, typename P::Rays& out) {
  for (unsigned i = 0; i < P::kRays; ++i) {
    out.org_x[i] = from[i].origin.x, out.org_y[i] = from[i].origin.y;
    out.org_z[i] = from[i].origin.z, out.tnear[i] = from[i].t_min;
    out.dir_x[i] = from[i].direction.x, out.dir_y[i] = from[i].direction.y;
    out.dir_z[i] = from[i].direction.z, out.tfar[i] = from[i].t_max;
  }
}

/// Loads as many rays as there are and have room. Lanes beyond the last are invalid; they hold
/// copies of the first ray, so that no garbage reaches Embree.
template <class P>
unsigned load_packet(std::span<const Ray> rays, int* valid, typename P::Rays& out) {
  const unsigned count = unsigned(std::min<size_t>(P::kRays, rays.size()));
  for (unsigned i = 0; i < P::kRays; ++i) valid[i] = i < count ? -1 : 0;
  if (count == P::kRays) {
    load_rays<P>(rays.data(), out);
  } else {
    std::array<Ray, P::kRays> padded;
    padded.fill(rays[0]);
    std::copy_n(rays.begin(), count, padded.begin());
    load_rays<P>(padded.data(), out);
  }
  return count;
}

/// Traces rays packet by packet until the first surface that blocks them: calls begin(first, count,
/// packet) before each, and end() likewise after it, where tfar < 0 says that a ray is blocked.
template <class P, class Begin, class End>
void trace_occluded(RTCScene top, Query& query, std::span<const Ray> rays, const Begin& begin,
                    const End& end) {
  typename P::Rays packet;
  begin_packets<P>(packet);
  for (size_t first = 0; first < rays.size(); first += P::kRays) {
    alignas(64) int valid[P::kRays];
    const unsigned count = load_packet<P>(rays.subspan(first), valid, packet);
    begin(first, count, packet);
    P::occluded(valid, top, &query.context, &packet);
    end(first, count, packet);
  }
}

}  // namespace

void RayTracer::closest_hits(std::span<const Ray> rays, std::span<Hit> hits,
                             Packets packets) const {
  closest_hits(rays, hits, packets, true);
}

void RayTracer::closest_covers(std::span<const Ray> rays, std::span<Hit> hits,
                               Packets packets) const {
  closest_hits(rays, hits, packets, false);
}

void RayTracer::closest_hits(std::span<const Ray> rays, std::span<Hit> hits, Packets packets,
                             bool by_chance) const {
  LUXEL_CHECK(rays.size() == hits.size());
  Query query{*impl_->scene, packet_context(impl_->is_coherent(packets, rays.size())),
              by_chance ? Through::chance : Through::none};
  with_packets(impl_->has_wide_vectors, [&]<class P>(P) {
    typename P::Hits packet;
    begin_packets<P>(packet.ray);
    for (size_t first = 0; first < rays.size(); first += P::kRays) {
      alignas(64) int valid[P::kRays];
      const unsigned count = load_packet<P>(rays.subspan(first), valid, packet.ray);
      for (unsigned i = 0; i < P::kRays; ++i)
        packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      P::intersect(valid, impl_->top, &query.context, &packet);
      // The surfaces that they hit, on the front or the back.
      for (unsigned i = 0; i < count; ++i) {
        Hit& hit = hits[first + i];
        if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
          hit = Hit{};
          continue;
        }
        const uint32_t instance = instance_of(packet.hit.instID[0][i], packet.hit.geomID[i]);
        const Vec3 normal{packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]};
        hit = {packet.ray.tfar[i],
               instance,
               packet.hit.primID[i],
               {packet.hit.u[i], packet.hit.v[i]},
               impl_->from_behind(instance, normal, rays[first + i].direction)};
        impl_->turn_to_ray(hit);
      }
    }
  });
}

Hit RayTracer::closest_hit(const Ray& ray) const {
  Hit hit;
  closest_hits({&ray, 1}, {&hit, 1});
  return hit;
}

void RayTracer::occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const {
  LUXEL_CHECK(rays.size() == blocked.size());
  Query query{*impl_->scene, packet_context()};
  with_packets(impl_->has_wide_vectors, [&]<class P>(P) {
    trace_occluded<P>(
        impl_->top, query, rays, [](size_t, unsigned, auto&) {},
        [&](size_t first, unsigned count, const auto& packet) {
          for (unsigned i = 0; i < count; ++i) blocked[first + i] = packet.tfar[i] < 0 ? 1 : 0;
        });
  });
}

namespace {

/// Data that is_empty() hands to Embree's callback.
struct BoxQuestion {
  const scene::Scene& scene;
  const TurnedBox& box;
  const std::function<bool(uint32_t, uint32_t)>& counts;
  bool is_empty = true;
};

/// True where all of a triangle lies beyond one of the box's sides.
bool is_outside(const scene::Triangle3& t, const TurnedBox& box) {
  const std::array<float, 3> half{box.half_m.x, box.half_m.y, box.half_m.z};
  for (size_t k = 0; k < 3; ++k) {
    const float a = dot(t.a - box.middle, box.axes[k]), b = dot(t.b - box.middle, box.axes[k]),
                c = dot(t.c - box.middle, box.axes[k]);
    if (std::min({a, b, c}) > half[k] || std::max({a, b, c}) < -half[k]) return true;
  }
  return false;
}

/// Returns whether the radius has changed: nothing more is looked at once something is found.
bool look_at_triangle(RTCPointQueryFunctionArguments* args) {
  BoxQuestion& question = *static_cast<BoxQuestion*>(args->userPtr);
  if (!question.counts(args->geomID, args->primID)) return false;
  if (is_outside(scene::world_triangle(question.scene, args->geomID, args->primID), question.box))
    return false;
  question.is_empty = false;
  args->query->radius = 0;
  return true;
}

}  // namespace

bool RayTracer::is_empty(const TurnedBox& box,
                         const std::function<bool(uint32_t, uint32_t)>& counts) const {
  if (impl_->has_shared_meshes) return false;
  BoxQuestion question{*impl_->scene, box, counts};
  RTCPointQuery query;
  query.x = box.middle.x, query.y = box.middle.y, query.z = box.middle.z;
  query.time = 0, query.radius = length(box.half_m);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->top, &query, &context, look_at_triangle, &question);
  return question.is_empty;
}

bool RayTracer::has_tints() const { return impl_->has_tints; }

void RayTracer::tint(std::span<const Ray> rays, std::span<const Hit> hits,
                     std::span<Rgb> light) const {
  LUXEL_CHECK(rays.size() == hits.size() && rays.size() == light.size());
  Query query{*impl_->scene, packet_context(), Through::tint};
  with_packets(impl_->has_wide_vectors, [&]<class P>(P) {
    trace_occluded<P>(
        impl_->top, query, rays,
        [&](size_t first, unsigned count, auto& packet) {
          // Up to just before the hit: what stands there has stopped the ray, not tinted it.
          for (unsigned i = 0; i < count; ++i)
            if (hits[first + i].found()) packet.tfar[i] = hits[first + i].t * (1 - 1e-6f);
          query.begin(light.subspan(first, count));
        },
        [](size_t, unsigned, auto&) {});
  });
}

void RayTracer::transmitted(std::span<const Ray> rays, std::span<Rgb> share) const {
  LUXEL_CHECK(rays.size() == share.size());
  // Without tints, only holes let light through: all of it.
  Query query{*impl_->scene, packet_context(), has_tints() ? Through::share : Through::chance};
  std::ranges::fill(share, Rgb{1, 1, 1});
  with_packets(impl_->has_wide_vectors, [&]<class P>(P) {
    trace_occluded<P>(
        impl_->top, query, rays,
        [&](size_t first, unsigned count, auto&) { query.begin(share.subspan(first, count)); },
        [&](size_t first, unsigned count, const auto& packet) {
          for (unsigned i = 0; i < count; ++i)
            if (packet.tfar[i] < 0) share[first + i] = {};
        });
  });
}

}  // namespace luxel::trace
