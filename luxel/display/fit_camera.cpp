// A camera for scenes that bring none.
//
// First inside or outside: a scene is looked at from inside when a good part of the places in it
// lie in rooms that have light, or when it has rooms with light and none outside. Then candidates
// stand in these rooms, in the streets of a town, or around the scene. Each looks with a coarse
// grid of rays and is scored by how much of the scene's front faces it shows, how finely what it
// shows is made, and how much of it lies in the light.
#include "luxel/display/fit_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/display/places_inside.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::display {
namespace {

constexpr float kDegree = kPi / 180;
constexpr float kOutsideFov = 40 * kDegree;
constexpr float kInsideFov = 60 * kDegree;
constexpr float kMargin = 1.04f;  ///< of the picture's size around the scene
constexpr int kProbeRows = 48;    ///< rays over the height of a candidate's picture

/// A scene counts as rooms when of its places in the air this part lies in rooms, and of those this
/// part has light. Towns, and gardens with a pavilion, have fewer rooms; the inside of a thing has
/// no light.
constexpr double kRooms = 0.5, kLitRooms = 0.1;
/// Rooms of which so much is seen from outside need no camera inside.
constexpr double kDollsHouse = 0.6;
/// Outside is dark when no camera there sees more than this share of its surfaces in the light.
constexpr double kDark = 0.1;
constexpr size_t kPlacesToTry = 24;
/// Part of the scene's diagonal.
constexpr double kWide = 0.25;

/// `liking` multiplies the score: a view from a little above reads better than a map.
struct Candidate {
  enum class From : uint8_t { outside, inside, street };
  scene::Camera camera;
  float liking = 1;
  From from = From::outside;
};

/// The scene and its data, which all candidates share.
struct Stage {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  Glimpse glimpse;
  std::vector<uint32_t> first;  ///< first_triangles()
  float aspect = 1, diagonal_m = 0;
};

/// Camera at `eye` looking along `direction` with +y up; not for vertical directions.
Mat34 look_along(Vec3 eye, Vec3 direction) {
  const Vec3 back = -normalize(direction);
  const Vec3 right = normalize(cross({0, 1, 0}, back));
  return from_columns(right, cross(back, right), back, eye);
}

Vec3 from_angles(float azimuth, float elevation) {
  return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
          std::cos(azimuth) * std::cos(elevation)};
}

scene::Camera camera_at(const Mat34& world_from_camera, float fov_y_rad) {
  scene::Camera camera;
  camera.name = "fitted";
  camera.world_from_camera = world_from_camera;
  camera.fov_y_rad = fov_y_rad;
  return camera;
}

/// Distance from the centre at which the eye must stand along `back` for the box's corners to be in
/// the frame: a corner at (x, y, z) in the camera's axes is inside when |x| <= (d - z) tan_x.
float fitting_distance(const Box3& box, const Mat34& axes, float tan_y, float aspect) {
  float distance = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y,
                      i & 4 ? box.upper.z : box.lower.z};
    const Vec3 p = corner - box.centre();
    const float x = dot(p, column(axes, 0)), y = dot(p, column(axes, 1));
    const float z = dot(p, column(axes, 2));
    distance = std::max({distance, z + std::abs(x) / (tan_y * aspect), z + std::abs(y) / tan_y});
  }
  return distance * kMargin + 1e-3f * box.diagonal();  // never on the surface
}

void add_outside(const Box3& box, float aspect, std::vector<Candidate>& out) {
  struct Height {
    float elevation, liking;
  };
  constexpr std::array<Height, 4> heights{
      {{3 * kDegree, 0.95f}, {15 * kDegree, 1.0f}, {35 * kDegree, 1.0f}, {60 * kDegree, 0.7f}}};
  const float tan_y = std::tan(0.5f * kOutsideFov);
  for (const Height& height : heights)
    for (int i = 0; i < 8; ++i) {
      const Vec3 back = from_angles(float(i) * 45 * kDegree, height.elevation);
      const Mat34 axes = look_along({}, -back);
      const Vec3 eye = box.centre() + back * fitting_distance(box, axes, tan_y, aspect);
      out.push_back({camera_at(look_along(eye, -back), kOutsideFov), height.liking});
    }
}

bool is_lit_room(const PlaceInside& p) { return is_enclosed(p) && is_lit(p); }

/// The places to look from: those in lit rooms, else those with most surfaces around them.
std::vector<PlaceInside> places_to_try(std::vector<PlaceInside> places) {
  std::ranges::stable_sort(places, [&](const PlaceInside& a, const PlaceInside& b) {
    return is_lit_room(a) != is_lit_room(b) ? is_lit_room(a) : a.around + a.lit > b.around + b.lit;
  });
  if (places.size() > kPlacesToTry) places.resize(kPlacesToTry);
  if (!places.empty() && is_lit_room(places.front()))
    std::erase_if(places, [&](const PlaceInside& p) { return !is_lit_room(p); });
  return places;
}

/// `elevation` [radians] of the cameras.
void add_inside(std::span<const PlaceInside> places, Candidate::From from, float elevation,
                std::vector<Candidate>& out) {
  for (const PlaceInside& place : places)
    for (int i = 0; i < 8; ++i) {
      const Vec3 ahead = from_angles(float(i) * 45 * kDegree, elevation);
      out.push_back({camera_at(look_along(place.eye, ahead), kInsideFov), 1.0f, from});
    }
}

/// Rays of one candidate that meet a triangle, and their area. `scratch` has an entry per triangle,
/// all zero before and after.
struct Seen {
  float area_m2 = 0;
  uint32_t rays = 0;
};

/// The front-face area [m^2] that the candidate's rays see, each triangle counted up to its own
/// area. A ray of solid angle w stands for the area t^2 w / cos of the surface it meets. Sums over
/// triangles in the order of first sight, so that equal scenes give equal scores.
struct View {
  double area_m2 = 0;
  double detail = 0;    ///< sum of sqrt(rays) over triangles / rays: 1 if each meets another one
  double coverage = 0;  ///< share of rays that see something
  double near = 0;      ///< share of rays blocked right before the eye
  double width = 0;     ///< mean distance seen, up to kWide, over kWide
  double lit = 0;       ///< share of what is seen that a light reaches
  double indoors = 0;   ///< share of the rays that see something with a roof above
};

/// For each hit, whether something is above it, or it is something above itself.
std::vector<uint8_t> under_a_roof(const Stage& stage, std::span<const trace::Ray> rays,
                                  std::span<const trace::Hit> hits) {
  std::vector<trace::Ray> upwards;
  for (size_t i = 0; i < hits.size(); ++i) {
    // A little before the surface, so that the ray does not begin on it.
    const float t = hits[i].found() ? hits[i].t * (1 - 1e-3f) : 0;
    upwards.push_back({rays[i].origin + rays[i].direction * t, 0, {0, 1, 0}, INFINITY});
  }
  std::vector<trace::Hit> above(hits.size());
  stage.tracer.closest_hits(upwards, above);
  std::vector<uint8_t> out(hits.size());
  for (size_t i = 0; i < hits.size(); ++i) out[i] = hits[i].found() && above[i].found();
  return out;
}

/// The things that a view is searched for: light and roofs take more rays than all else. Backs of
/// one-sided materials are invisible but for the last.
enum class LookFor : uint8_t { surfaces, all, backs };

View look(const Stage& stage, const Candidate& candidate, LookFor what,
          std::vector<Seen>& scratch) {
  const scene::Scene& scene = stage.scene;
  const int rows = kProbeRows, columns = std::clamp(int(float(rows) * stage.aspect), 8, 4 * rows);
  const trace::CameraRays rays_of(candidate.camera, columns, rows);
  std::vector<trace::Ray> rays;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      rays.push_back(rays_of.through(float(x) + 0.5f, float(y) + 0.5f));
  std::vector<trace::Hit> hits(rays.size());
  if (what == LookFor::backs)
    stage.tracer.closest_hits(rays, hits);
  else
    hits = trace::visible_hits(scene, stage.tracer, rays);
  const bool all = what == LookFor::all;
  const std::vector<uint8_t> lit =
      all ? lit_by_sources(scene, stage.tracer, stage.glimpse, rays, hits)
          : std::vector<uint8_t>(hits.size(), 1);
  const bool inside = candidate.from == Candidate::From::inside;
  const std::vector<uint8_t> roofed =
      all && inside ? under_a_roof(stage, rays, hits) : std::vector<uint8_t>(hits.size(), 1);

  View view;
  const float pixel = 4 * length(rays_of.right) * length(rays_of.up) / float(rows * columns);
  std::vector<uint32_t> touched;
  for (size_t i = 0; i < hits.size(); ++i) {
    const trace::Hit& hit = hits[i];
    if (!hit.found()) continue;
    view.coverage += 1;
    view.lit += lit[i], view.indoors += roofed[i];
    if (hit.t < 0.03f * stage.diagonal_m) view.near += 1;
    view.width += std::min(1.0, double(hit.t) / (kWide * double(stage.diagonal_m)));
    const float axis = dot(rays[i].direction, rays_of.forward);  // a pixel's solid angle: cos^3
    const float cosine =
        std::abs(dot(rays[i].direction, front_normal(scene, hit.instance, hit.triangle)));
    const float area = hit.t * hit.t * pixel * axis * axis * axis / std::max(cosine, 0.05f);
    const uint32_t number = stage.first[hit.instance] + hit.triangle;
    if (scratch[number].rays++ == 0) touched.push_back(number);
    scratch[number].area_m2 += area;
  }
  for (uint32_t number : touched) {
    const auto [instance, triangle] = scene::drawn_triangle(stage.first, number);
    const float whole = area_m2(world_triangle(scene, instance, triangle));
    view.area_m2 += double(std::min(scratch[number].area_m2, whole));
    view.detail += std::sqrt(double(scratch[number].rays));
    scratch[number] = {};
  }
  view.lit /= std::max(view.coverage, 1.0);
  view.width /= std::max(view.coverage, 1.0);
  view.coverage /= double(rays.size());
  view.detail /= double(rays.size());
  view.near /= double(rays.size());
  view.indoors /= double(rays.size());
  return view;
}

/// Full marks for a frame that is 40 to 95 % filled; inside a room it is filled by nature, and
/// above a street there is some sky.
double coverage_marks(const Candidate& candidate, const View& view) {
  if (view.coverage < 0.4) return view.coverage / 0.4;
  if (candidate.from == Candidate::From::street) return 1 - 2 * std::max(0.0, view.coverage - 0.85);
  if (view.coverage > 0.95 && candidate.from == Candidate::From::outside) return 0.8;
  return 1;
}

/// Things are shown by their lit side, and by their shadows: full marks where three quarters to
/// nine tenths of what is seen lie in the light. With the light straight behind the eye there is no
/// form.
double light_marks(const Stage& stage, const View& view) {
  if (stage.glimpse.sources.empty()) return 1;
  return 0.3 + 0.7 * std::min(1.0, view.lit / 0.75) - 1.5 * std::max(0.0, view.lit - 0.9);
}

/// True: the lights leave all views in the dark. With surroundings nothing is dark.
bool is_dark(const Stage& stage, std::span<const Candidate> candidates) {
  if (stage.glimpse.has_surroundings || stage.glimpse.sources.empty()) return false;
  std::vector<uint8_t> dark(candidates.size());
  parallel_for(candidates.size(), 8, [&](size_t begin, size_t end) {
    std::vector<Seen> scratch(stage.first.back());
    for (size_t i = begin; i < end; ++i)
      dark[i] = look(stage, candidates[i], LookFor::all, scratch).lit <= kDark;
  });
  return std::ranges::all_of(dark, [](uint8_t d) { return d != 0; });
}

/// A score of surfaces alone is the highest that the whole may be: light and roofs only lower it.
double score_of(const Stage& stage, const Candidate& candidate, LookFor what,
                std::vector<Seen>& scratch) {
  const View view = look(stage, candidate, what, scratch);
  // Inside, the finest thing of all is close to the eye soon: the room is what is to be seen.
  const double detail = candidate.from == Candidate::From::outside
                            ? view.detail
                            : std::sqrt(view.detail) * view.width;
  // A picture of rooms is not meant to show the view through windows.
  const double indoors = candidate.from == Candidate::From::inside ? view.indoors : 1;
  return detail * std::sqrt(view.area_m2) * coverage_marks(candidate, view) *
         light_marks(stage, view) * (1 - view.near) * indoors * double(candidate.liking);
}

/// The scores of those candidates that are numbered in `which`.
std::vector<double> scores_of(const Stage& stage, std::span<const Candidate> candidates,
                              std::span<const uint32_t> which, LookFor what) {
  std::vector<double> scores(which.size());
  parallel_for(which.size(), 4, [&](size_t begin, size_t end) {
    std::vector<Seen> scratch(stage.first.back());
    for (size_t k = begin; k < end; ++k)
      scores[k] = score_of(stage, candidates[which[k]], what, scratch);
  });
  return scores;
}

/// The first of those with the highest score. Light and roofs are looked at from the most promising
/// ones, until no other can be better.
scene::Camera best_of(const Stage& stage, std::span<const Candidate> candidates) {
  constexpr size_t kAtATime = 16;
  std::vector<uint32_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0u);
  const std::vector<double> most = scores_of(stage, candidates, order, LookFor::surfaces);
  if (std::ranges::max(most) <= 0) {
    // The fronts of flipped surfaces are seen from nowhere; a picture of their backs says so.
    const std::vector<double> backs = scores_of(stage, candidates, order, LookFor::backs);
    return candidates[size_t(std::ranges::max_element(backs) - backs.begin())].camera;
  }
  std::ranges::stable_sort(order, [&](uint32_t a, uint32_t b) { return most[a] > most[b]; });
  uint32_t best = order.front();
  double highest = -1;
  for (size_t begin = 0; begin < order.size() && most[order[begin]] >= highest; begin += kAtATime) {
    const auto which = std::span(order).subspan(begin, std::min(kAtATime, order.size() - begin));
    const std::vector<double> scores = scores_of(stage, candidates, which, LookFor::all);
    for (size_t k = 0; k < which.size(); ++k)
      if (scores[k] > highest || (scores[k] == highest && which[k] < best))
        highest = scores[k], best = which[k];
  }
  return candidates[best].camera;
}

/// An elevation or a plan: all of the box, by parallel rays along the camera's -z.
scene::Camera parallel_view(const Box3& box, Vec3 right, Vec3 up, float aspect) {
  const Vec3 back = cross(right, up), size = box.upper - box.lower;
  const auto along = [&](Vec3 axis) { return std::abs(dot(size, axis)); };
  const float distance = 0.5f * along(back) + std::max(1e-3f, 0.1f * box.diagonal());
  scene::Camera camera =
      camera_at(from_columns(right, up, back, box.centre() + back * distance), kOutsideFov);
  camera.orthographic_height_m =
      kMargin * std::max({along(up), along(right) / aspect, 1e-3f * box.diagonal()});
  return camera;
}

/// The scene consists of rooms, and not all of them are dark.
bool consists_of_rooms(std::span<const PlaceInside> places) {
  const auto enclosed = std::ranges::count_if(places, is_enclosed);
  const auto lit = std::ranges::count_if(places, is_lit_room);
  return lit > 0 && double(enclosed) >= kRooms * double(places.size()) &&
         double(lit) >= kLitRooms * double(enclosed);
}

/// The share of what rooms show from inside that the best of the cameras outside sees, too: most of
/// it where walls are one-sided or missing, as in a dolls' house.
double share_seen_from_outside(const Stage& stage, std::span<const PlaceInside> places,
                               std::span<const Candidate> outside) {
  std::vector<SeenSide> sides;
  for (const PlaceInside& place : places)
    if (is_enclosed(place))
      for (size_t i = 0; i < place.seen.size(); i += 8) sides.push_back(place.seen[i]);
  size_t most = 0;
  for (const Candidate& candidate : outside) {
    const Vec3 eye = column(candidate.camera.world_from_camera, 3);
    std::vector<trace::Ray> rays;
    for (const SeenSide& side : sides)
      if (dot(side.normal, eye - side.at) > 0) rays.push_back({eye, 0, side.at - eye, INFINITY});
    size_t seen = 0;
    for (const trace::Hit& hit : trace::visible_hits(stage.scene, stage.tracer, rays))
      seen += hit.found() && std::abs(hit.t - 1) < 1e-3f;
    most = std::max(most, seen);
  }
  return sides.empty() ? 1 : double(most) / double(sides.size());
}

Stage stage_of(const scene::Scene& scene, const trace::RayTracer& tracer, float aspect) {
  return {scene,
          tracer,
          glimpse_of(scene),
          first_triangles(scene),
          aspect,
          world_bounds(scene).diagonal()};
}

/// Candidates for Viewpoint::automatic.
std::vector<Candidate> usual_candidates(const Stage& stage, const Box3& box) {
  std::vector<Candidate> outside, inside;
  add_outside(box, stage.aspect, outside);
  std::vector<PlaceInside> places = places_inside(stage.scene, stage.tracer, stage.glimpse);
  const bool only_inside_is_lit =
      std::ranges::any_of(places, is_lit_room) && is_dark(stage, outside);
  if (!only_inside_is_lit) {
    if (!consists_of_rooms(places)) {
      const auto streets = places_in_streets(stage.scene, stage.tracer, stage.glimpse);
      for (const float degrees : {0.0f, 5.0f})
        add_inside(streets, Candidate::From::street, degrees * kDegree, inside);
      return inside.empty() ? outside : inside;
    }
    if (share_seen_from_outside(stage, places, outside) >= kDollsHouse) return outside;
  }
  add_inside(places_to_try(std::move(places)), Candidate::From::inside, 0, inside);
  return inside;
}

}  // namespace

scene::Camera fit_camera(const scene::Scene& scene, const trace::RayTracer& tracer, float aspect,
                         Viewpoint from) {
  LUXEL_CHECK(aspect > 0);
  const Box3 box = world_bounds(scene);
  if (box.empty()) return camera_at({}, kOutsideFov);
  if (from == Viewpoint::front) return parallel_view(box, {1, 0, 0}, {0, 1, 0}, aspect);
  if (from == Viewpoint::top) return parallel_view(box, {1, 0, 0}, {0, 0, -1}, aspect);
  const Stage stage = stage_of(scene, tracer, aspect);
  std::vector<Candidate> candidates;
  if (from == Viewpoint::automatic) candidates = usual_candidates(stage, box);
  if (from == Viewpoint::interior)
    add_inside(places_to_try(places_inside(scene, tracer, stage.glimpse)), Candidate::From::inside,
               0, candidates);
  if (candidates.empty()) add_outside(box, aspect, candidates);
  return best_of(stage, candidates);
}

}  // namespace luxel::display
