// Points of texels' footprints, and whether they lie in the open.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "luxel/light/shadow_rays.h"
#include "luxel/light/texel_scene.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/elements.h"
#include "luxel/transport/own_side.h"

namespace luxel::light {

/// For one of many points, and for the sample of a texel, as gather asks.
inline constexpr int kEnclosureRays = 16, kEnclosureRaysOfTexel = 64;

/// The scene of all points.
struct PointScene {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
};

inline PointScene point_scene(const TexelScene& in) { return {in.scene, in.tracer}; }

/// True where a point lies inside a solid. A place gets the same answer in every bake.
inline bool is_enclosed(const PointScene& at, const Receiver& r, int rays = kEnclosureRays) {
  return transport::is_enclosed(at.scene, at.tracer, r.position, r.normal, rays);
}

inline Receiver receiver_at(const transport::SmoothPoint& s, uint64_t seed) {
  return {s.start, s.normal, s.geometric_normal, seed};
}

/// The sample of a texel, without a seed: enough to be asked whether it is enclosed.
inline Receiver own_receiver(const transport::Elements& elements, size_t i) {
  return {elements.position[i], elements.normal[i], elements.geometric_normal[i]};
}

/// Which points of a texel's footprint lie on its sample's side of walls. Returns the number of
/// rays.
inline uint64_t find_on_side(const TexelScene& in, size_t texel,
                             std::span<const scene::SurfacePoint> points,
                             std::vector<uint8_t>& on_side) {
  on_side.resize(points.size());
  return transport::find_on_side(in.scene, in.atlas, in.tracer, in.map.texels[texel].sample, points,
                                 on_side);
}

/// The sample of a texel has the backs of some surfaces before it.
inline bool sees_backs(const PointScene& at, const Receiver& own) {
  return transport::all_backs(transport::count_back_faces(at.scene, at.tracer, own.position,
                                                          own.normal, kEnclosureRays)) > 0;
}

/// Gets the open points of texel number `texel` of the map, one at least.
using AtPoints = std::function<void(size_t texel, std::span<const Receiver> points)>;

/// Calls `visit` for each texel that is not `hidden` with up to `count` points of its footprint,
/// spread evenly, without those inside of solids or beyond walls; its own sample where no other is
/// left. Each
/// point has a seed of its own. Many threads call at a time. Errors: cancelled.
Status visit_points(const TexelScene& in, std::span<const uint8_t> hidden, int count, uint64_t seed,
                    std::string_view stage, const AtPoints& visit, Progress& progress);

}  // namespace luxel::light
