#include "luxel/view/draw/shadow_maps.h"

#include <algorithm>
#include <cmath>

#include "luxel/scene/light_kinds.h"

namespace luxel::view {
namespace {

constexpr uint32_t kSmallestCell = 64;
/// Texels around what a map is to show: shaders/direct.glsl looks up some that lie beside it.
constexpr float kMargin = 6;
constexpr float kNearest = 1e-3f;  ///< of the scene's diagonal: what is nearer casts no shadow
constexpr float kNarrowCone = 1.2f;
/// A near map reaches as much less far as the next one.
constexpr float kNearer = 0.3f;

/// Unit axes of a view.
struct View {
  Vec3 right, up, forward;
};

View view_along(Vec3 forward) {
  const Vec3 aside = std::abs(forward.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  const Vec3 right = normalize(cross(forward, aside));
  return {right, cross(right, forward), forward};
}

std::array<float, 16> by_columns(const std::array<std::array<float, 4>, 4>& rows) {
  std::array<float, 16> out{};
  for (size_t r = 0; r < 4; ++r)
    for (size_t k = 0; k < 4; ++k) out[4 * k + r] = rows[r][k];
  return out;
}

float with_margin(float side) { return side / (side - 2 * kMargin); }

/// From a place; `tangent`: of half the angle that is shown.
ShadowMap map_from(Vec3 eye, Vec3 forward, float tangent, float near_m, float side) {
  const View view = view_along(forward);
  const float half = tangent * with_margin(side);
  const auto row = [&](Vec3 v) { return std::array{v.x, v.y, v.z, -dot(v, eye)}; };
  ShadowMap out;
  out.clip_from_world = by_columns(
      {row(view.right / half), row(view.up / half), {0, 0, 0, near_m}, row(view.forward)});
  out.side = side, out.texel_m = 2 * half / side;
  return out;
}

/// A box as a view sees it.
Box3 seen_by(const View& view, const Box3& bounds) {
  Box3 seen;
  for (int k = 0; k < 8; ++k) {
    const Vec3 p{k & 1 ? bounds.upper.x : bounds.lower.x, k & 2 ? bounds.upper.y : bounds.lower.y,
                 k & 4 ? bounds.upper.z : bounds.lower.z};
    seen.extend({dot(p, view.right), dot(p, view.up), dot(p, view.forward)});
  }
  return seen;
}

/// A square of the view about `middle`, and all depths of a box; `seen`: as the view sees it.
ShadowMap map_of_square(const View& view, Vec2 middle_xy, float half, const Box3& seen,
                        float side) {
  const Vec3 middle{middle_xy.x, middle_xy.y, seen.centre().z}, size = seen.upper - seen.lower;
  // Depth stays within 0.25 and 0.75: what is flat has some, too.
  const float widest = std::max({size.x, size.y, 2e-6f});
  const float depth = 2 * std::max(size.z, 0.5f * widest * with_margin(side));
  const auto row = [](Vec3 v, float w) { return std::array{v.x, v.y, v.z, w}; };
  ShadowMap out;
  out.clip_from_world = by_columns({row(view.right / half, -middle.x / half),
                                    row(view.up / half, -middle.y / half),
                                    row(view.forward / -depth, 0.5f + middle.z / depth),
                                    {0, 0, 0, 1}});
  out.side = side, out.texel_m = 2 * half / side, out.depth_m = depth;
  return out;
}

/// All of a box along a direction.
ShadowMap map_along(Vec3 direction, const Box3& bounds, float side) {
  const View view = view_along(normalize(direction));
  const Box3 seen = seen_by(view, bounds);
  const Vec3 middle = seen.centre(), size = seen.upper - seen.lower;
  const float half = std::max(0.5f * std::max(size.x, size.y), 1e-6f) * with_margin(side);
  return map_of_square(view, {middle.x, middle.y}, half, seen, side);
}

/// Farthest reach of a box from the eye along its view [m]; 0: it lies behind.
float farthest_m(const trace::CameraRays& eye, const Box3& bounds) {
  float out = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3 p{k & 1 ? bounds.upper.x : bounds.lower.x, k & 2 ? bounds.upper.y : bounds.lower.y,
                 k & 4 ? bounds.upper.z : bounds.lower.z};
    out = std::max(out, dot(p - eye.eye, eye.forward));
  }
  return out;
}

/// Maps along a direction of what is seen up to some distances, the nearest first. They move by
/// whole texels, so that edges stand still when the eye moves. `all` is the map of everything.
std::vector<ShadowMap> near_maps(Vec3 direction, const Box3& bounds, const trace::CameraRays& eye,
                                 const ShadowMap& all) {
  std::vector<ShadowMap> out;
  if (eye.orthographic) return out;
  const View view = view_along(normalize(direction));
  const Box3 seen = seen_by(view, bounds);
  const float spread2 = dot(eye.right, eye.right) + dot(eye.up, eye.up);
  float reach_m = farthest_m(eye, bounds), texel_m = all.texel_m;
  for (size_t k = 0; k < kMostNearMaps; ++k) {
    reach_m *= kNearer;
    const float pixel_m = 2 * length(eye.up) * reach_m / eye.height;
    if (texel_m <= pixel_m) continue;  // as sharp as can be seen
    // The ball around the eye and the corners of the picture at that distance.
    const float ahead_m = std::min(0.5f * reach_m * (1 + spread2), reach_m);
    const float rest_m = reach_m - ahead_m;
    const float half =
        std::sqrt(std::max(ahead_m * ahead_m, rest_m * rest_m + reach_m * reach_m * spread2)) *
        with_margin(all.side);
    const float width_m = 2 * half / all.side;
    if (width_m >= all.texel_m) continue;
    const Vec3 middle = eye.eye + eye.forward * ahead_m;
    const auto whole = [&](Vec3 along) {
      return std::round(dot(middle, along) / width_m) * width_m;
    };
    out.insert(out.begin(),
               map_of_square(view, {whole(view.right), whole(view.up)}, half, seen, all.side));
    texel_m = width_m;
  }
  return out;
}

bool looks_all_round(const scene::PunctualLight& light) {
  if (!scene::has_position(light.kind)) return false;
  return !scene::has_cone(light.kind) || light.outer_cone_rad > kNarrowCone;
}

std::vector<ShadowMap> maps_of(const scene::PunctualLight& light, const Box3& bounds, float side) {
  if (!scene::has_position(light.kind)) return {map_along(light.direction, bounds, side)};
  const float near_m = kNearest * bounds.diagonal();
  if (!looks_all_round(light))
    return {map_from(light.position, normalize(light.direction),
                     std::max(std::tan(light.outer_cone_rad), 1e-3f), near_m, side)};
  std::vector<ShadowMap> out;
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    for (const float sign : {1.0f, -1.0f})
      out.push_back(map_from(light.position, axis * sign, 1, near_m, side));
  return out;
}

/// Cells that a lamp's maps take: six maps of a cell, or one that is two cells wide.
size_t cells_of(const scene::PunctualLight& light) { return looks_all_round(light) ? 6 : 4; }

/// A square of cells that are given away, those in squares of two by two first.
class Cells {
 public:
  explicit Cells(uint32_t side) : side_(side / 2 * 2) {}
  size_t count() const { return size_t(side_) * side_; }
  size_t left() const { return count() - taken_; }
  /// The left upper cell of a square of 1 or 2 along its side.
  std::array<uint32_t, 2> take(uint32_t along) {
    const auto square = uint32_t(taken_ / 4), part = uint32_t(taken_ % 4);
    taken_ += size_t(along) * along;
    const uint32_t across = side_ / 2;
    return {2 * (square % across) + part % 2, 2 * (square / across) + part / 2};
  }

 private:
  uint32_t side_;
  size_t taken_ = 0;
};

/// Puts those near maps of a sun before its own for which cells are to spare, the nearest ones last
/// of all to be left out.
void add_near_maps(const trace::CameraRays& eye, const scene::PunctualLight& sun,
                   const Box3& bounds, size_t& spare, std::vector<ShadowMap>& maps) {
  std::vector<ShadowMap> near = near_maps(sun.direction, bounds, eye, maps[0]);
  const size_t kept = std::min(near.size(), spare / cells_of(sun));
  spare -= kept * cells_of(sun);
  maps.insert(maps.begin(), near.begin(), near.begin() + std::ptrdiff_t(kept));
}

}  // namespace

ShadowPlan plan_shadows(std::span<const scene::PunctualLight> lights, const Box3& bounds,
                        uint32_t picture_side, const trace::CameraRays* eye) {
  size_t wanted = 0;
  for (const scene::PunctualLight& light : lights) wanted += cells_of(light);
  uint32_t side = std::min(kLargestShadowMap / 2, picture_side / 2);
  while (Cells(picture_side / side).count() < wanted && side > kSmallestCell) side /= 2;
  Cells cells(picture_side / side);
  ShadowPlan out;
  out.first_map.assign(lights.size(), scene::kNone), out.looks_all_round.assign(lights.size(), 0);
  out.map_count.assign(lights.size(), 0);
  size_t spare = Cells(picture_side / side).count();  // for near maps
  spare -= std::min(spare, wanted);
  // Large ones first: then small ones leave no gap in which none of them fits.
  for (const bool is_round : {false, true})
    for (size_t i = 0; i < lights.size(); ++i) {
      if (looks_all_round(lights[i]) != is_round) continue;
      out.looks_all_round[i] = is_round;
      const uint32_t along = is_round ? 1 : 2;  // of cells
      std::vector<ShadowMap> maps = maps_of(lights[i], bounds, float(along * side));
      if (cells.left() < cells_of(lights[i])) continue;
      if (eye && !scene::has_position(lights[i].kind))
        add_near_maps(*eye, lights[i], bounds, spare, maps);
      out.first_map[i] = uint32_t(out.maps.size()), out.map_count[i] = uint32_t(maps.size());
      for (ShadowMap& map : maps) {
        const auto [x, y] = cells.take(along);
        map.corner = {float(x * side), float(y * side)};
        out.maps.push_back(map);
      }
    }
  return out;
}

}  // namespace luxel::view
