#include "luxel/light/reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/environment.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::light {
namespace {

/// Directions are unit in float, and so are sines and cosines of theirs.
constexpr double kDirectionRounding = 1e-6;

/// Parameters that intervals may miss each other by, relative to where they end: intersections are
/// worked out in double from floats, exact to some 1e-16.
constexpr double kParameterRounding = 1e-12;

/// Boxes grow by this share of the largest coordinate of the scene, with where instances lie:
/// shadow rays start off the surface by up to 2^-21 of it, or of 14 of it where triangles as large
/// as the scene lean (scene::off_surface), and meet what is there with the precision of float.
constexpr float kRayRounding = 0x1p-15f;

/// Bright texels that lie wider about their middle come from everywhere.
constexpr double kWidest = 80 * kPiDouble / 180;

/// Elements that a thread takes at a time: each costs some ten comparisons per box and light.
constexpr size_t kGrain = 256;

/// Parameters t at which a swept box overlaps another.
struct Interval {
  double first = 0, last = HUGE_VAL;

  /// Keeps those with at_zero + t slope <= 0.
  void keep_below(double at_zero, double slope) {
    if (slope > 0)
      last = std::min(last, -at_zero / slope);
    else if (slope < 0)
      first = std::max(first, -at_zero / slope);
    else if (at_zero > 0)
      last = -1;
  }
  bool empty() const { return last < first - kParameterRounding * std::max(1.0, first); }
};

/// Speeds of the sides of a box [per t].
struct Sides {
  std::array<double, 3> lower{}, upper{};
};

bool sweeps_over(const Box3& from, const Sides& speed, double last, const Box3& box) {
  Interval t{0, last};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = size_t(axis);
    t.keep_below(double(from.lower[axis]) - double(box.upper[axis]), speed.lower[k]);
    t.keep_below(double(box.lower[axis]) - double(from.upper[axis]), -speed.upper[k]);
  }
  return !t.empty();
}

/// The components of all directions of a cone.
Sides directions_of(Vec3 axis, double half_angle) {
  Sides out;
  for (int k = 0; k < 3; ++k) {
    const double angle = std::acos(std::clamp(double(axis[k]), -1.0, 1.0));
    out.lower[size_t(k)] = std::cos(std::min(kPiDouble, angle + half_angle)) - kDirectionRounding;
    out.upper[size_t(k)] = std::cos(std::max(0.0, angle - half_angle)) + kDirectionRounding;
  }
  return out;
}

struct Cone {
  Vec3 axis;
  double half_angle = 0;
};

/// A cone that holds all bright texels of the surroundings; nothing where it is too wide to tell
/// anything.
std::optional<Cone> cone_of_bright_texels(const scene::Environment& map,
                                          const Surroundings& around) {
  const auto middle = [&](uint32_t pixel) {
    const uint32_t width = uint32_t(map.width);
    return scene::direction_of(map, {(float(pixel % width) + 0.5f) / float(map.width),
                                     (float(pixel / width) + 0.5f) / float(map.height)});
  };
  Vec3 sum;
  for (const uint32_t pixel : around.bright_texels) sum += middle(pixel);
  const Cone none{normalize(sum), 0};
  if (none.axis == Vec3{}) return std::nullopt;
  double least = 1;
  for (const uint32_t pixel : around.bright_texels)
    least = std::min(least, double(dot(middle(pixel), none.axis)));
  // From the middle of a pixel to its edge along the meridian and, at most, along the equator.
  const double pixel = kPiDouble / (2 * map.height) + kPiDouble / map.width;
  // Near 1 the cosine tells angles to the root of its rounding.
  const double half_angle = std::acos(std::clamp(least - kDirectionRounding, -1.0, 1.0)) + pixel;
  if (half_angle > kWidest) return std::nullopt;
  return Cone{none.axis, half_angle};
}

Box3 grown(const Box3& box, float by_m) {
  const Vec3 r{by_m, by_m, by_m};
  return {box.lower - r, box.upper + r};
}

Box3 box_around(Vec3 centre, float radius_m) { return grown({centre, centre}, radius_m); }

/// All that shines, ready to be asked.
class Reach {
 public:
  Reach(const scene::Scene& scene, const Lights& lights, std::span<const Box3> boxes)
      : lights_(lights), has_bright_texels_(!lights.around.bright_texels.empty()) {
    if (has_bright_texels_)
      if (const auto cone = cone_of_bright_texels(scene.environment, lights.around))
        bright_texels_ = directions_of(cone->axis, cone->half_angle);
    for (const scene::PunctualLight& light : lights.punctual)
      suns_.push_back(scene::has_position(light.kind)
                          ? Sides{}
                          : directions_of(-light.direction, double(light.angular_radius_rad)));
    Box3 all = scene::world_bounds(scene);
    for (const Box3& box : boxes)
      if (!box.empty()) all.extend(box.lower), all.extend(box.upper);
    for (const scene::Instance& i : scene.instances) all.extend(column(i.world_from_object, 3));
    const float margin = kRayRounding * max_component(max(-all.lower, all.upper));
    for (const Box3& box : boxes)
      if (!box.empty()) boxes_.push_back(grown(box, margin));
  }

  bool includes(const Box3& place) const {
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box3& box) {
      return around_crosses(place, box) || punctual_lights_cross(place, box) ||
             triangles_cross(place, box);
    });
  }

 private:
  bool around_crosses(const Box3& place, const Box3& box) const {
    if (!has_bright_texels_) return false;
    return !bright_texels_ || sweeps_over(place, *bright_texels_, HUGE_VAL, box);
  }

  bool punctual_lights_cross(const Box3& place, const Box3& box) const {
    for (size_t k = 0; k < lights_.punctual.size(); ++k)
      if (max_component(lights_.punctual[k].intensity) > 0 && punctual_crosses(k, place, box))
        return true;
    return false;
  }

  bool punctual_crosses(size_t number, const Box3& place, const Box3& box) const {
    const scene::PunctualLight& light = lights_.punctual[number];
    switch (light.kind) {
      case scene::LightKind::directional:
        return sweeps_over(place, suns_[number], HUGE_VAL, box);
      case scene::LightKind::point:
      case scene::LightKind::spot: {
        const float nearest =
            length(max(place.lower, min(light.position, place.upper)) - light.position);
        if (light.range_m > 0 && nearest > light.range_m) return false;
        return may_cross(place, {light.position, light.position}, box);
      }
    }
    return false;
  }

  /// Down the hierarchy, into groups of triangles whose spheres' boxes may be seen across the box.
  bool triangles_cross(const Box3& place, const Box3& box, uint32_t node = 0) const {
    if (lights_.nodes.empty()) return false;
    const LightNode& group = lights_.nodes[node];
    if (group.right_child == 0) {
      const TriangleLight& light = lights_.triangles[group.first];
      Box3 bounds;
      for (const Vec3 corner : {light.a, light.b, light.c}) bounds.extend(corner);
      return may_cross(place, bounds, box);
    }
    const Box3 sphere = box_around(group.centre, group.radius_m * (1 + kRayRounding));
    return may_cross(place, sphere, box) && (triangles_cross(place, box, node + 1) ||
                                             triangles_cross(place, box, group.right_child));
  }

  const Lights& lights_;
  bool has_bright_texels_ = false;
  std::optional<Sides>
      bright_texels_;        ///< of directions; nothing: from everywhere, where there are any
  std::vector<Sides> suns_;  ///< the same of each directional light
  std::vector<Box3> boxes_;
};

}  // namespace

bool may_cross(const Box3& from, const Box3& to, const Box3& box) {
  if (from.empty() || to.empty() || box.empty()) return false;
  Sides speed;
  for (int axis = 0; axis < 3; ++axis) {
    speed.lower[size_t(axis)] = double(to.lower[axis]) - double(from.lower[axis]);
    speed.upper[size_t(axis)] = double(to.upper[axis]) - double(from.upper[axis]);
  }
  return sweeps_over(from, speed, 1, box);
}

bool may_cross(const Box3& from, Vec3 towards, float angular_radius_rad, const Box3& box) {
  if (from.empty() || box.empty()) return false;
  return sweeps_over(from, directions_of(towards, double(angular_radius_rad)), HUGE_VAL, box);
}

std::vector<uint8_t> elements_in_reach(const scene::Scene& scene,
                                       const transport::Elements& elements,
                                       std::span<const float> radius_m, const Lights& lights,
                                       std::span<const Box3> boxes) {
  LUXEL_CHECK(radius_m.size() == elements.size());
  const Reach reach(scene, lights, boxes);
  std::vector<uint8_t> out(elements.size());
  parallel_for(out.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out[i] = reach.includes(box_around(elements.position[i], radius_m[i]));
  });
  return out;
}

}  // namespace luxel::light
