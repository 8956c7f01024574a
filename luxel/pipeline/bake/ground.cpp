#include "luxel/pipeline/bake/ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "luxel/display/draw.h"
#include "luxel/display/smooth_lookup.h"
#include "luxel/light/direct_light.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::pipeline {
namespace {

/// Places along a side, and rays from each to the sky and to each sun.
constexpr int kGroundSide = 144, kRaysToSky = 64, kRaysToSuns = 16;
/// In diagonals of the scene's box: half the side, and how far the ground lies below the scene, so
/// that a bottom that stands on it is above it.
constexpr float kHalfSide = 1.25f, kBelow = 1e-4f;
/// The part of the half side where shadows begin to fade out. They are gone at its end.
constexpr float kFadesFrom = 0.6f;

/// A floor is level and among the lowest quarter of a scene, and a fifth of what is seen from
/// above. Feet, wheels and leaves are less.
constexpr int kFloorLooks = 48;
constexpr float kLowPart = 0.25f, kLevel = 0.9f;
constexpr double kFloorShare = 0.2;

bool has_floor(const scene::Scene& scene, const trace::RayTracer& tracer, const Box3& box) {
  const Vec3 size = box.upper - box.lower;
  std::vector<trace::Ray> rays;
  for (int i = 0; i < kFloorLooks * kFloorLooks; ++i) {
    const float u = (float(i % kFloorLooks) + 0.5f) / kFloorLooks,
                v = (float(i / kFloorLooks) + 0.5f) / kFloorLooks;
    rays.push_back(
        {{box.lower.x + u * size.x, box.upper.y + 0.01f * box.diagonal(), box.lower.z + v * size.z},
         0,
         {0, -1, 0},
         INFINITY});
  }
  const std::vector<trace::Hit> hits = trace::visible_hits(scene, tracer, rays);
  const auto is_floor = [&](const trace::Hit& hit) {
    return hit.found() &&
           std::abs(scene::front_normal(scene, hit.instance, hit.triangle).y) > kLevel &&
           scene::world_position(scene, hit.point()).y <= box.lower.y + kLowPart * size.y;
  };
  return double(std::ranges::count_if(hits, is_floor)) >= kFloorShare * double(hits.size());
}

bool looks_at_an_object(const scene::Camera& camera, const Box3& box) {
  const Vec3 eye = column(camera.world_from_camera, 3);
  const Vec3 forward = -normalize(column(camera.world_from_camera, 2));
  const auto within = [](float x, float a, float b) { return a <= x && x <= b; };
  const bool is_inside = within(eye.x, box.lower.x, box.upper.x) &&
                         within(eye.y, box.lower.y, box.upper.y) &&
                         within(eye.z, box.lower.z, box.upper.z);
  return !is_inside && eye.y > box.lower.y && forward.y < -0.02f;
}

void add_place(Vec3 at, transport::Elements& out) {
  out.position.push_back(at);
  out.normal.push_back({0, 1, 0}), out.geometric_normal.push_back({0, 1, 0});
  out.reflectance.push_back({});
}

/// The middles of the ground's pixels, row by row, and last a place above the whole scene, which
/// sees all of the sky.
transport::Elements ground_places(const Ground& ground, const Box3& box) {
  transport::Elements out;
  const auto along = [&](int i) {
    return ground.half_side_m * (2 * (float(i) + 0.5f) / kGroundSide - 1);
  };
  for (int y = 0; y < kGroundSide; ++y)
    for (int x = 0; x < kGroundSide; ++x)
      add_place({ground.middle.x + along(x), ground.height_m, ground.middle.y + along(y)}, out);
  add_place({ground.middle.x, box.upper.y + box.diagonal(), ground.middle.y}, out);
  return out;
}

/// 1 where `open` is not darker, and where it is 0.
float share_of(float e, float open) { return open > e ? e / open : 1; }

/// E over that of the last place, per pixel.
image::Image shares_of(std::span<const Rgb> irradiance) {
  const Rgb open = irradiance.back();
  image::Image out(kGroundSide, kGroundSide, 4);
  for (int i = 0; i < kGroundSide * kGroundSide; ++i) {
    const int x = i % kGroundSide, y = i / kGroundSide;
    const Rgb e = irradiance[size_t(i)];
    out.set_rgb(x, y, {share_of(e.x, open.x), share_of(e.y, open.y), share_of(e.z, open.z)});
    out.at(x, y)[3] = 1;
  }
  return out;
}

/// Each pixel with its neighbours, in the weights 1 2 1 along either side: half the noise of rays.
image::Image softened(const image::Image& sharp) {
  image::Image out = sharp;
  for (int y = 1; y + 1 < sharp.height; ++y)
    for (int x = 1; x + 1 < sharp.width; ++x) {
      Rgb sum{};
      for (int k = 0; k < 9; ++k) {
        const int dx = k % 3 - 1, dy = k / 3 - 1;
        sum += sharp.rgb(x + dx, y + dy) * float((2 - std::abs(dx)) * (2 - std::abs(dy)));
      }
      out.set_rgb(x, y, sum * (1.0f / 16));
    }
  return out;
}

}  // namespace

Result<std::optional<Ground>> ground_under(const scene::Scene& scene,
                                           const trace::RayTracer& tracer,
                                           const scene::Camera& camera, const Progress& progress) {
  const Box3 box = scene::world_bounds(scene);
  if (box.empty() || !scene.cameras.empty() || display::has_void(scene) ||
      !looks_at_an_object(camera, box) || has_floor(scene, tracer, box))
    return std::optional<Ground>();
  Ground out;
  out.height_m = box.lower.y - kBelow * box.diagonal();
  out.half_side_m = kHalfSide * box.diagonal();
  out.middle = {box.centre().x, box.centre().z};
  light::DirectParams params;
  params.samples = kRaysToSuns, params.sky_samples = kRaysToSky;
  Progress own;  // a part of drawing the picture
  LUXEL_TRY(const light::DirectLight direct,
            light::direct_light(scene, ground_places(out, box), light::collect_lights(scene),
                                tracer, params, own));
  LUXEL_TRY_STATUS(stopped(progress));
  out.light = softened(shares_of(direct.irradiance));
  return std::optional<Ground>(std::move(out));
}

Rgb light_on(const Ground& ground, const trace::Ray& ray) {
  constexpr Rgb kAll{1, 1, 1};
  const float t = (ground.height_m - ray.origin.y) / ray.direction.y;
  if (!(ray.direction.y < 0) || !(t > 0)) return kAll;
  const Vec3 at = ray.origin + ray.direction * t;
  const Vec2 from_middle = Vec2{at.x, at.z} - ground.middle;
  const float away = length(from_middle) / ground.half_side_m;
  if (away >= 1) return kAll;
  const Vec2 uv = from_middle * (0.5f / ground.half_side_m) + Vec2{0.5f, 0.5f};
  const float s = std::clamp((away - kFadesFrom) / (1 - kFadesFrom), 0.0f, 1.0f);
  const float kept = 1 - s * s * (3 - 2 * s);
  return kAll + (display::smooth_at(ground.light, uv) - kAll) * kept;
}

}  // namespace luxel::pipeline
