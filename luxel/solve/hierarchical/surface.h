// From places on faces to surface points of the scene, and back.
#pragma once

#include <optional>

#include "luxel/solve/hierarchical/tree.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::hierarchical {

/// The point of the scene at a place of a face; nothing in a hole of a mask.
std::optional<scene::SurfacePoint> solid_point(const Faces& faces, const trace::RayTracer& tracer,
                                               uint32_t face, DVec3 place);

/// The point of the scene's triangles at a place of a face: on a curved face in closed form, on
/// others what a short ray meets there.
scene::SurfacePoint surface_point(const scene::Scene& scene, const Faces& faces,
                                  const trace::RayTracer& tracer, uint32_t face, DVec3 place);

/// The face and the place of a surface point; face is kNone on a triangle without area.
struct FacePoint {
  uint32_t face = kNone;
  DVec3 position;
};
/// Finds the face of the point's triangle.
FacePoint face_point_of(const scene::Scene& scene, const Faces& faces,
                        const scene::SurfacePoint& p);

/// The nearest place of all faces whose normals are about along `normal`, which is unit: those
/// whose cosine is at least 0.7. Nothing: any face will do. face is kNone where there is none.
FacePoint nearest_face_point(const Faces& faces, DVec3 point, std::optional<DVec3> normal);

}  // namespace luxel::hierarchical
