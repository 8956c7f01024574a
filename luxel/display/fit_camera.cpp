// A camera for scenes that bring none.
//
// Candidates stand around the scene (one-sided walls are culled, so a room shows itself like a
// dolls' house) and inside it. Each looks at the scene with a coarse grid of rays and is scored by
// how much of the scene's front faces it shows, and how finely what it shows is made: the outer
// walls of a house are large, but what people put their triangles into stands inside.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/display/draw.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::display {
namespace {

constexpr float kDegree = kPi / 180;
constexpr float kOutsideFov = 40 * kDegree;
constexpr float kInsideFov = 55 * kDegree;
constexpr int kProbeRows = 48;  ///< rays over the height of a candidate's picture

/// `liking` multiplies the score: a view from a little above reads better than a map.
struct Candidate {
  scene::Camera camera;
  float liking = 1;
  bool inside = false;
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

/// How far from the centre the eye must stand along `back` for the box's corners to be in the
/// frame: a corner at (x, y, z) in the camera's axes is inside when |x| <= (d - z) tan_x.
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
  return distance * 1.04f + 1e-3f * box.diagonal();  // a margin, and never on the surface
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
      out.push_back({camera_at(look_along(eye, -back), kOutsideFov), height.liking, false});
    }
}

/// Whether surfaces are around the eye, as in a room or a street, and not only on one side of it.
bool is_surrounded(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 eye) {
  constexpr int kDirections = 64;
  std::vector<trace::Ray> rays;
  for (int i = 0; i < kDirections; ++i) {  // a spiral of equal areas
    const float y = 1 - 2 * (float(i) + 0.5f) / kDirections, r = std::sqrt(1 - y * y);
    const float phi = 2.3999632f * float(i);
    rays.push_back({eye, 0, {r * std::cos(phi), y, r * std::sin(phi)}, INFINITY});
  }
  int found = 0;
  for (const trace::Hit& hit : trace::visible_hits(scene, tracer, rays)) found += hit.found();
  return 5 * found >= 3 * kDirections;
}

void add_inside(const scene::Scene& scene, const trace::RayTracer& tracer, const Box3& box,
                std::vector<Candidate>& out) {
  const Vec3 size = box.upper - box.lower;
  const float eye_height = box.lower.y + std::min(1.6f, 0.3f * size.y);
  constexpr std::array<Vec2, 5> places{
      {{0.5f, 0.5f}, {0.25f, 0.5f}, {0.75f, 0.5f}, {0.5f, 0.25f}, {0.5f, 0.75f}}};
  for (const float y : {box.lower.y + 0.5f * size.y, eye_height})
    for (const Vec2 place : places) {
      const Vec3 eye{box.lower.x + place.x * size.x, y, box.lower.z + place.y * size.z};
      if (!is_surrounded(scene, tracer, eye)) continue;
      for (int i = 0; i < 8; ++i) {
        const Vec3 ahead = from_angles(float(i) * 45 * kDegree, 0);
        out.push_back({camera_at(look_along(eye, ahead), kInsideFov), 1.0f, true});
      }
    }
}

/// What one candidate's rays meet. `scratch` has an entry per triangle, all zero before and after.
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
};

View look(const scene::Scene& scene, const trace::RayTracer& tracer,
          const std::vector<uint32_t>& first, const Candidate& candidate, float aspect,
          float diagonal, std::vector<Seen>& scratch) {
  const int rows = kProbeRows, columns = std::clamp(int(float(rows) * aspect), 8, 4 * rows);
  const trace::CameraRays rays_of(candidate.camera, columns, rows);
  std::vector<trace::Ray> rays;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      rays.push_back(rays_of.through(float(x) + 0.5f, float(y) + 0.5f));
  const std::vector<trace::Hit> hits = trace::visible_hits(scene, tracer, rays);

  View view;
  const float pixel = 4 * length(rays_of.right) * length(rays_of.up) / float(rows * columns);
  std::vector<uint32_t> touched;
  for (size_t i = 0; i < hits.size(); ++i) {
    const trace::Hit& hit = hits[i];
    if (!hit.found()) continue;
    view.coverage += 1;
    if (hit.t < 0.03f * diagonal) view.near += 1;
    const float axis = dot(rays[i].direction, rays_of.forward);  // a pixel's solid angle: cos^3
    const float cosine =
        std::abs(dot(rays[i].direction, front_normal(scene, hit.instance, hit.triangle)));
    const float area = hit.t * hit.t * pixel * axis * axis * axis / std::max(cosine, 0.05f);
    const uint32_t number = first[hit.instance] + hit.triangle;
    if (scratch[number].rays++ == 0) touched.push_back(number);
    scratch[number].area_m2 += area;
  }
  for (uint32_t number : touched) {
    const auto [instance, triangle] = scene::drawn_triangle(first, number);
    const float whole = area_m2(world_triangle(scene, instance, triangle));
    view.area_m2 += double(std::min(scratch[number].area_m2, whole));
    view.detail += std::sqrt(double(scratch[number].rays));
    scratch[number] = {};
  }
  view.coverage /= double(rays.size());
  view.detail /= double(rays.size());
  view.near /= double(rays.size());
  return view;
}

/// Full marks for a frame that is 40 to 95 % filled; inside a room it is filled by nature.
double coverage_marks(const Candidate& candidate, const View& view) {
  if (view.coverage < 0.4) return view.coverage / 0.4;
  if (view.coverage > 0.95 && !candidate.inside) return 0.8;
  return 1;
}

}  // namespace

scene::Camera fit_camera(const scene::Scene& scene, const trace::RayTracer& tracer, float aspect) {
  LUXEL_CHECK(aspect > 0);
  const Box3 box = world_bounds(scene);
  if (box.empty()) return camera_at({}, kOutsideFov);
  std::vector<Candidate> candidates;
  add_outside(box, aspect, candidates);
  add_inside(scene, tracer, box, candidates);

  const std::vector<uint32_t> first = first_triangles(scene);
  std::vector<double> scores(candidates.size());
  parallel_for(candidates.size(), 8, [&](size_t begin, size_t end) {
    std::vector<Seen> scratch(first.back());
    for (size_t i = begin; i < end; ++i) {
      const View view = look(scene, tracer, first, candidates[i], aspect, box.diagonal(), scratch);
      scores[i] = view.detail * std::sqrt(view.area_m2) * coverage_marks(candidates[i], view) *
                  (1 - view.near) * double(candidates[i].liking);
    }
  });
  const size_t best = size_t(std::max_element(scores.begin(), scores.end()) - scores.begin());
  return candidates[best].camera;
}

}  // namespace luxel::display
