// Finds the part of a hierarchical solution under the pointer. [Hardt96, appendix B.4.6]
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "luxel/solve/hierarchical/light_mesh.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::view {

/// A solution that is looked into, and what it was made from. It refers to them.
struct SolutionView {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const hierarchical::Solution& solution;
  const hierarchical::LightMesh* mesh = nullptr;         ///< null: there is none yet
  hierarchical::DiscontinuityParams discontinuity = {};  ///< of `mesh`
};

/// A link, by the id of its receiver and its number in Links::of.
struct LinkNumber {
  uint32_t receiver = 0, number = 0;
  friend bool operator==(const LinkNumber&, const LinkNumber&) = default;
};

/// The place of a face that is seen at a pixel; none where no face is.
std::optional<hierarchical::FacePoint> face_point_seen(const SolutionView& view,
                                                       const trace::CameraRays& camera, Vec2 pixel);

/// Ids of all that hold a place of a face, from the root of the tree to the leaf: clusters, then
/// elements.
std::vector<uint32_t> path_to(const SolutionView& view, const hierarchical::FacePoint& at);

/// The triangle of the light mesh that holds a place of a face, or the nearest one of its leaf;
/// none without a mesh.
std::optional<uint32_t> triangle_at(const SolutionView& view, const hierarchical::FacePoint& at);

/// The middle of an element or a cluster, where its links begin and end [m].
DVec3 middle_of(const hierarchical::Tree& tree, uint32_t id);

/// Where a line is seen, from pixel to pixel; none where all of it lies behind the eye.
std::optional<std::array<Vec2, 2>> pixels_of(const trace::CameraRays& camera, DVec3 from, DVec3 to);
/// Distance of a pixel from a line [pixels].
float distance_to(const std::array<Vec2, 2>& line, Vec2 pixel);

/// So near to a line the pointer takes hold of it [pixels].
inline constexpr float kPickReach = 10;

/// Distance of a line from the pixel or place that points at it, over the reach: up to 1 it is
/// meant. None where it is not seen.
using Nearness = std::function<std::optional<double>(DVec3 from, DVec3 to)>;
/// From a pixel, over kPickReach.
Nearness near_pixel(const trace::CameraRays& camera, Vec2 pixel);
/// From a place in space, over `reach_m`.
Nearness near_place(DVec3 place, double reach_m);

/// The nearest link of those that end at any of some elements or clusters; none within reach.
std::optional<LinkNumber> link_near(const SolutionView& view, std::span<const uint32_t> receivers,
                                    const Nearness& nearness);

/// The nearest discontinuity; the heaviest of those that are about as near. `weight` is of each.
/// None within reach.
std::optional<uint32_t> discontinuity_near(
    std::span<const hierarchical::Discontinuity> discontinuities, std::span<const double> weight,
    const Nearness& nearness);

}  // namespace luxel::view
