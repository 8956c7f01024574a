#include "luxel/transport/back_faces.h"

#include <algorithm>
#include <array>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/off_surface.h"

namespace luxel::transport {

namespace {

constexpr size_t kMost = 64;

/// The set's directions about (0, 0, 1).
const std::array<Vec3, kMost>& directions() {
  static const auto all = [] {
    std::array<Vec3, kMost> out;
    for (uint32_t k = 0; k < kMost; ++k) out[k] = cosine_hemisphere_sample(sobol_owen_2d(k, 3));
    return out;
  }();
  return all;
}

/// The first rays of the set, and what they meet.
struct Look {
  std::array<trace::Ray, kMost> rays;
  std::array<trace::Hit, kMost> hits;
  size_t count = 0;
};

/// Traces the set's rays up to so many; those that the look has stay.
void look_further(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, size_t count,
                  Look& look) {
  const auto frame = frame_around(normal);
  const size_t first = look.count;
  for (size_t k = first; k < count; ++k)
    look.rays[k] = {from, 0, frame.to_world(directions()[k]), INFINITY};
  tracer.closest_hits(std::span(look.rays).subspan(first, count - first),
                      std::span(look.hits).subspan(first, count - first));
  look.count = count;
}

Look look_from(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, size_t count) {
  Look out;
  look_further(tracer, from, normal, count, out);
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

/// At least seven eighths of the rays met backs: then it is worth knowing what the fronts are.
bool sees_nearly_backs_alone(const BackFaces& seen) {
  return 8 * all_backs(seen) >= 7 * int64_t(seen.rays);
}

/// True where a place sees nothing but backs, or mostly those of one-sided surfaces, by all rays of
/// the set.
bool sees_backs_alone(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                      Vec3 normal) {
  Look look = look_from(tracer, from, normal, kMost / 2);
  // With no back of a one-sided surface in the first half, the second cannot make a majority of
  // them; two that are no backs are too many.
  const BackFaces half = backs_of(scene, look);
  if (half.one_sided == 0 && half.rays - all_backs(half) >= 2) return false;
  look_further(tracer, from, normal, kMost, look);
  return is_enclosed(backs_of(scene, look));
}

/// True where a place lies inside a solid, by all rays of the set. A front that itself sees nothing
/// but backs counts as a back, such as the floor within a box whose own bottom lies just as high:
/// rays meet either of the two. `look`: from there, with some of the rays.
bool is_shut_in(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, Vec3 normal,
                Look& look) {
  look_further(tracer, from, normal, kMost, look);
  BackFaces seen = backs_of(scene, look);
  if (is_enclosed(seen)) return true;
  if (!sees_nearly_backs_alone(seen)) return false;
  if (std::ranges::any_of(look.hits, [&](const trace::Hit& hit) {
        return !hit.found() || max_component(scene::emission_at(scene, hit.point())) > 0;
      }))
    return false;
  int open = 0;
  for (const trace::Hit& hit : look.hits) {
    if (hit.back_face) continue;
    const Vec3 front = scene::front_normal(scene, hit.instance, hit.triangle);
    const Vec3 at = scene::off_surface(scene, hit.point(), front);
    // One may be anything, as in is_enclosed.
    if (!sees_backs_alone(scene, tracer, at, front) && ++open > 1) return false;
  }
  return true;
}

/// True where a place lies inside a solid, by the rays of `look`, and by all of the set where those
/// are not sure.
bool is_enclosed_by(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                    Vec3 normal, Look& look) {
  const BackFaces seen = backs_of(scene, look);
  return is_enclosed(seen) ||
         (sees_nearly_backs_alone(seen) && is_shut_in(scene, tracer, from, normal, look));
}

}  // namespace

BackFaces count_back_faces(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                           Vec3 normal, int rays) {
  LUXEL_CHECK(rays > 0 && size_t(rays) <= kMost);
  return backs_of(scene, look_from(tracer, from, normal, size_t(rays)));
}

bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, Vec3 normal,
                 int rays) {
  LUXEL_CHECK(rays > 0 && size_t(rays) <= kMost);
  Look look = look_from(tracer, from, normal, size_t(rays));
  return is_enclosed_by(scene, tracer, from, normal, look);
}

bool is_in_the_open(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                    Vec3 normal) {
  constexpr int kFewRays = 8, kRays = 32;
  Look look = look_from(tracer, from, normal, kFewRays);
  BackFaces seen = backs_of(scene, look);
  if (all_backs(seen) == 0) return true;
  if (is_enclosed(seen)) return false;
  while (seen.rays < kRays) {
    look_further(tracer, from, normal, size_t(seen.rays + kFewRays), look);
    seen = backs_of(scene, look);
    // Even if all that is left were backs.
    const int left = kRays - seen.rays;
    const BackFaces most{kRays, seen.one_sided + left, seen.double_sided};
    if (!is_hidden(most) && !sees_nearly_backs_alone(most)) return true;
  }
  return !is_enclosed_by(scene, tracer, from, normal, look);
}

bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                 const Elements& elements, size_t i, const BackFaces& own) {
  if (4 * own.one_sided < own.rays && !sees_nearly_backs_alone(own)) return false;
  if (4 * own.one_sided > 3 * own.rays) return true;
  Look look;
  return is_shut_in(scene, tracer, elements.position[i], elements.normal[i], look);
}

std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements,
                                   const std::function<BackFaces(size_t)>& own) {
  std::vector<uint8_t> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out[i] = is_enclosed(scene, tracer, elements, i, own(i));
  });
  return out;
}

std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements) {
  // Most places see no backs: a few rays tell.
  constexpr int kFirst = 16;
  std::vector<uint8_t> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 from = elements.position[i];
      Look look = look_from(tracer, from, elements.normal[i], kFirst);
      if (all_backs(backs_of(scene, look)) == 0) continue;
      look_further(tracer, from, elements.normal[i], kMost, look);
      out[i] = is_enclosed_by(scene, tracer, from, elements.normal[i], look);
    }
  });
  return out;
}

}  // namespace luxel::transport
