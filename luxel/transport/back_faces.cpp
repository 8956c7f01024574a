#include "luxel/transport/back_faces.h"

#include <array>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"

namespace luxel::transport {

namespace {

constexpr size_t kMost = 64;

/// The first rays of the set, and what they meet.
struct Look {
  std::array<trace::Ray, kMost> rays;
  std::array<trace::Hit, kMost> hits;
  size_t count = 0;
};

Look look_from(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, size_t count) {
  Look out;
  out.count = count;
  const auto frame = frame_around(normal);
  for (uint32_t k = 0; k < count; ++k)
    out.rays[k] = {from, 0, frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 3))),
                   INFINITY};
  tracer.closest_hits(std::span(out.rays).first(count), std::span(out.hits).first(count));
  return out;
}

BackFaces backs_of(const scene::Scene& scene, const Look& look) {
  BackFaces seen{int(look.count), 0, 0};
  for (const trace::Hit& hit : std::span(look.hits).first(look.count)) {
    if (!hit.found() || !hit.back_face) continue;
    const scene::Material& material = scene::material_at(scene, hit.point());
    ++(scene::reflects_from_behind(material) ? seen.double_sided : seen.one_sided);
  }
  return seen;
}

/// Whether all but a few rays met backs: then it is worth knowing what the fronts are.
bool sees_nearly_backs_alone(const BackFaces& seen) {
  return 8 * all_backs(seen) >= 7 * int64_t(seen.rays);
}

/// Whether a place sees nothing but backs, by all rays of the set.
bool sees_backs_alone(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                      Vec3 normal) {
  return is_enclosed(backs_of(scene, look_from(tracer, from, normal, kMost)));
}

/// Whether a place lies inside a solid, by all rays of the set. A front that itself sees nothing
/// but backs counts as a back: the floor within a box whose own bottom lies just as high, so that
/// rays meet either.
bool is_shut_in(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, Vec3 normal,
                float diagonal_m) {
  const Look look = look_from(tracer, from, normal, kMost);
  BackFaces seen = backs_of(scene, look);
  if (is_enclosed(seen)) return true;
  if (!sees_nearly_backs_alone(seen)) return false;
  int open = 0;
  for (const trace::Hit& hit : look.hits) {
    if (!hit.found() || max_component(scene::emission_at(scene, hit.point())) > 0) return false;
    if (hit.back_face) continue;
    const Vec3 front = scene::front_normal(scene, hit.instance, hit.triangle);
    const Vec3 at =
        trace::offset_origin(scene::world_position(scene, hit.point()), front, diagonal_m);
    // One may be anything, as in is_enclosed.
    if (!sees_backs_alone(scene, tracer, at, front) && ++open > 1) return false;
  }
  return true;
}

}  // namespace

BackFaces count_back_faces(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                           Vec3 normal, int rays) {
  LUXEL_CHECK(rays > 0 && size_t(rays) <= kMost);
  return backs_of(scene, look_from(tracer, from, normal, size_t(rays)));
}

bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, Vec3 normal,
                 int rays, float diagonal_m) {
  const BackFaces seen = count_back_faces(scene, tracer, from, normal, rays);
  return is_enclosed(seen) ||
         (sees_nearly_backs_alone(seen) && is_shut_in(scene, tracer, from, normal, diagonal_m));
}

bool is_in_the_open(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                    Vec3 normal, float diagonal_m) {
  constexpr int kFirstRays = 8, kRays = 32;
  const BackFaces few = count_back_faces(scene, tracer, from, normal, kFirstRays);
  if (all_backs(few) == 0) return true;
  return !is_enclosed(few) && !is_enclosed(scene, tracer, from, normal, kRays, diagonal_m);
}

bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                 const Elements& elements, size_t i, const BackFaces& own, float diagonal_m) {
  if (4 * own.one_sided < own.rays && !sees_nearly_backs_alone(own)) return false;
  if (4 * own.one_sided > 3 * own.rays) return true;
  const Vec3 from =
      trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
  return is_shut_in(scene, tracer, from, elements.normal[i], diagonal_m);
}

std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements,
                                   const std::function<BackFaces(size_t)>& own) {
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::vector<uint8_t> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out[i] = is_enclosed(scene, tracer, elements, i, own(i), diagonal_m);
  });
  return out;
}

std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements) {
  // Most places see no backs: a few rays tell.
  constexpr int kFirst = 16;
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::vector<uint8_t> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 from =
          trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
      const BackFaces few = count_back_faces(scene, tracer, from, elements.normal[i], kFirst);
      out[i] = all_backs(few) > 0 &&
               is_enclosed(scene, tracer, from, elements.normal[i], int(kMost), diagonal_m);
    }
  });
  return out;
}

}  // namespace luxel::transport
