#include "luxel/display/places_inside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "luxel/trace/camera_rays.h"

namespace luxel::display {
namespace {

constexpr int kDirections = 128;
/// A room has windows and doors; an alley, or a yard under the sky, has no roof.
constexpr double kAround = 0.88, kAbove = 0.9;
/// Light on one or two of the surfaces seen may be a leak.
constexpr double kLit = 3.0 / kDirections;
constexpr float kEyeLevel_m = 1.6f;
/// Of the scene's diagonal: what is thinner is a sheet, not a room.
constexpr float kSheet = 1e-3f;
/// A place that sees so much of what emits lies in a lamp.
constexpr double kInALamp = 0.9;

/// Directions that share the sphere evenly: a spiral from the top down.
std::array<Vec3, kDirections> directions() {
  std::array<Vec3, kDirections> out;
  for (int i = 0; i < kDirections; ++i) {
    const float y = 1 - 2 * (float(i) + 0.5f) / kDirections, r = std::sqrt(1 - y * y);
    const float phi = 2.3999632f * float(i);
    out[size_t(i)] = {r * std::cos(phi), y, r * std::sin(phi)};
  }
  return out;
}

/// Whether a ray meets a solid from inside.
bool is_inner_side(const scene::Scene& scene, const trace::Hit& hit) {
  return hit.found() && hit.back_face &&
         !scene::reflects_from_behind(scene::material_at(scene, hit.point()));
}

/// Eye level between the floor and the ceiling at a place, or between the floor and the scene's
/// top; none where no floor is under it, or no room.
std::optional<Vec3> at_eye_level(const scene::Scene& scene, const trace::RayTracer& tracer,
                                 const Box3& box, Vec3 place) {
  const trace::Hit down = tracer.closest_hit({place, 0, {0, -1, 0}, INFINITY});
  if (!down.found() || is_inner_side(scene, down)) return std::nullopt;
  const trace::Hit up = tracer.closest_hit({place, 0, {0, 1, 0}, INFINITY});
  const float floor = place.y - down.t;
  const float height = (up.found() ? place.y + up.t : box.upper.y) - floor;
  if (height < kSheet * box.diagonal()) return std::nullopt;
  place.y = floor + std::clamp(kEyeLevel_m, 0.4f * height, 0.6f * height);
  return place;
}

/// Nothing when the place lies inside a solid, most of whose walls show their backs, in a sheet or
/// in a lamp.
std::optional<PlaceInside> look_around(const scene::Scene& scene, const trace::RayTracer& tracer,
                                       const Glimpse& glimpse, float diagonal_m, Vec3 eye) {
  std::vector<trace::Ray> rays;
  for (const Vec3 d : directions()) rays.push_back({eye, 0, d, INFINITY});
  std::vector<trace::Hit> first(rays.size());
  tracer.closest_hits(rays, first);
  int backs = 0, found_first = 0, emitting = 0, close = 0;
  for (const trace::Hit& hit : first) {
    if (!hit.found()) continue;
    backs += is_inner_side(scene, hit), ++found_first;
    emitting += max_component(scene::material_at(scene, hit.point()).emission) > 0;
    close += hit.t < 0.5f * kSheet * diagonal_m;
  }
  if (2 * backs > kDirections || 2 * close > found_first ||
      double(emitting) > kInALamp * double(found_first))
    return std::nullopt;

  const std::vector<trace::Hit> hits = trace::visible_hits(scene, tracer, rays);
  const std::vector<uint8_t> direct = lit_by_sources(scene, tracer, glimpse, rays, hits);
  const std::vector<uint8_t> sky = lit_by_surroundings(scene, tracer, glimpse, rays, hits);
  PlaceInside place;
  place.eye = eye;
  int found = 0, rising = 0, above = 0, lit = 0;
  for (size_t i = 0; i < hits.size(); ++i) {
    const bool is_above = rays[i].direction.y > 0.5f;
    if (hits[i].found()) place.seen.push_back(side_seen_by(scene, rays[i], hits[i]));
    found += hits[i].found(), lit += direct[i] || sky[i];
    rising += is_above, above += is_above && hits[i].found();
  }
  place.around = double(found) / kDirections, place.above = double(above) / rising;
  place.lit = double(lit) / kDirections;
  return place;
}

}  // namespace

bool is_enclosed(const PlaceInside& place) {
  return place.around >= kAround && place.above >= kAbove;
}

bool is_lit(const PlaceInside& place) { return place.lit >= kLit; }

std::vector<PlaceInside> places_inside(const scene::Scene& scene, const trace::RayTracer& tracer,
                                       const Glimpse& glimpse) {
  constexpr int kColumns = 48, kLevels = 3;
  const Box3 box = world_bounds(scene);
  const Vec3 size = box.upper - box.lower;
  std::vector<PlaceInside> out;
  for (int column = 0; column < kColumns; ++column)
    for (int level = 0; level < kLevels; ++level) {
      // Columns that follow no street grid: multiples of the plastic number's powers, modulo 1.
      const Vec3 part{std::fmod(0.5f + 0.7548777f * float(column), 1.0f),
                      (float(level) + 0.5f) / kLevels,
                      std::fmod(0.5f + 0.5698403f * float(column), 1.0f)};
      const auto eye = at_eye_level(scene, tracer, box, box.lower + part * size);
      if (!eye) continue;
      const bool known = std::ranges::any_of(out, [&](const PlaceInside& place) {
        return length(place.eye - *eye) < 1e-3f * box.diagonal();
      });
      if (known) continue;
      if (const auto place = look_around(scene, tracer, glimpse, box.diagonal(), *eye))
        out.push_back(*place);
    }
  return out;
}

}  // namespace luxel::display
