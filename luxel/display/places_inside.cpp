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
/// Part of the scene's diagonal: a room that is lower is a sheet.
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

/// A ray meets a solid from inside.
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

/// A scene from above: the heights of what rays from the sky meet, in kCells^2 cells over its box.
constexpr int kCells = 64;
struct Relief {
  std::vector<float> height;   ///< -infinity where there is nothing
  float ground = 0, tall = 0;  ///< heights of the ground, and of all but a tenth of what rises
  Box3 box;

  Vec3 middle_of(int cell) const {
    const float x = (float(cell % kCells) + 0.5f) / kCells,
                z = (float(cell / kCells) + 0.5f) / kCells;
    return {box.lower.x + x * (box.upper.x - box.lower.x), height[size_t(cell)],
            box.lower.z + z * (box.upper.z - box.lower.z)};
  }
  bool is_ground(int cell) const {
    return std::abs(height[size_t(cell)] - ground) < 0.1f * (tall - ground);
  }
  bool is_built(int cell) const { return height[size_t(cell)] > ground + 0.4f * (tall - ground); }
};

float quantile(std::vector<float> values, double part) {
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// `ground` and `tall` are equal where nothing rises.
Relief relief_of(const scene::Scene& scene, const trace::RayTracer& tracer) {
  Relief out;
  out.box = world_bounds(scene);
  out.height.assign(size_t(kCells * kCells), out.box.upper.y + out.box.diagonal());
  std::vector<trace::Ray> rays;
  for (int cell = 0; cell < kCells * kCells; ++cell)
    rays.push_back({out.middle_of(cell), 0, {0, -1, 0}, INFINITY});
  std::vector<trace::Hit> hits(rays.size());
  tracer.closest_hits(rays, hits);
  std::vector<float> found, rising;
  for (size_t i = 0; i < hits.size(); ++i) {
    out.height[i] = hits[i].found() ? rays[i].origin.y - hits[i].t : -INFINITY;
    if (hits[i].found()) found.push_back(out.height[i]);
  }
  if (found.empty()) return out;
  out.ground = out.tall = quantile(found, 0.2);
  const float highest = *std::ranges::max_element(found);
  for (const float h : found)
    if (h - out.ground > 0.1f * (highest - out.ground)) rising.push_back(h);
  if (!rising.empty()) out.tall = quantile(std::move(rising), 0.9);
  return out;
}

/// The number of buildings that stand apart.
int count_buildings(const Relief& relief) {
  constexpr int kLeastCells = 4;
  std::vector<uint8_t> seen(relief.height.size());
  int buildings = 0;
  for (int first = 0; first < kCells * kCells; ++first) {
    int cells = 0;
    std::vector<int> to_visit{first};
    while (!to_visit.empty()) {
      const int cell = to_visit.back();
      to_visit.pop_back();
      if (seen[size_t(cell)] || !relief.is_built(cell)) continue;
      seen[size_t(cell)] = 1, ++cells;
      if (cell % kCells > 0) to_visit.push_back(cell - 1);
      if (cell % kCells < kCells - 1) to_visit.push_back(cell + 1);
      if (cell >= kCells) to_visit.push_back(cell - kCells);
      if (cell < kCells * (kCells - 1)) to_visit.push_back(cell + kCells);
    }
    buildings += cells >= kLeastCells;
  }
  return buildings;
}

/// Open ground, and no wall within a cell.
bool has_room_to_stand(const Relief& relief, int cell) {
  const int x = cell % kCells, z = cell / kCells;
  if (std::min(x, z) < 1 || std::max(x, z) > kCells - 2) return false;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dx = -1; dx <= 1; ++dx)
      if (!relief.is_ground(cell + dz * kCells + dx)) return false;
  return true;
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

std::vector<PlaceInside> places_in_streets(const scene::Scene& scene,
                                           const trace::RayTracer& tracer, const Glimpse& glimpse) {
  constexpr int kFewBuildings = 4, kPlaces = 48;
  // Parts of the box's cells. Houses cover more of a town than trees of a garden.
  constexpr double kLeastGround = 0.15, kLeastBuilt = 0.15;
  constexpr double kWalls = 0.58;  // the ground fills one half of all directions
  const Relief relief = relief_of(scene, tracer);
  int ground = 0, built = 0;
  std::vector<int> standing;
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    ground += relief.is_ground(cell), built += relief.is_built(cell);
    if (has_room_to_stand(relief, cell)) standing.push_back(cell);
  }
  if (!(relief.tall > relief.ground) || ground < kLeastGround * kCells * kCells ||
      built < kLeastBuilt * kCells * kCells || count_buildings(relief) < kFewBuildings)
    return {};
  std::vector<PlaceInside> out;
  const size_t step = std::max(standing.size() / kPlaces, size_t(1));
  for (size_t i = step / 2; i < standing.size(); i += step) {
    Vec3 eye = relief.middle_of(standing[i]);
    eye.y += std::min(kEyeLevel_m, 0.15f * (relief.tall - relief.ground));
    const auto place = look_around(scene, tracer, glimpse, relief.box.diagonal(), eye);
    if (place && place->around >= kWalls && place->above < kAbove) out.push_back(*place);
  }
  return out;
}

}  // namespace luxel::display
