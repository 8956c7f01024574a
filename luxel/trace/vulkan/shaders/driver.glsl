// Rays through a hierarchy that the driver has made, by the units of the device that are for this:
// ../driver_hierarchy.h.
#extension GL_EXT_ray_query : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "ray.glsl"

// A part of the hierarchy where it stands: DriverInstance. Its triangles without and with
// surfaces that let light through follow each other.
struct HierarchyPart {
  uint first_triangle[2];
  uint first_number;
  uint shared_by;  // the instance; in the world kNotShared
};
HierarchyPart part_at(World world, int index) {
  uvec4 a = floatBitsToUint(world.triangles.at[3 * index]);
  return HierarchyPart(uint[2](a.x, a.y), a.z, a.w);
}

// Whether the surface that the query is at lets the ray through.
bool passes(World world, Ray ray, rayQueryEXT query) {
  HierarchyPart part = part_at(world, rayQueryGetIntersectionInstanceCustomIndexEXT(query, false));
  uint k = part.first_triangle[1] + uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
  uint open = floatBitsToUint(world.triangles.at[3 * k + 2].w);
  return lets_through(world.see_through, open - 1, part.shared_by,
                      rayQueryGetIntersectionBarycentricsEXT(query, false), ray.origin, ray.direction);
}

// The first triangle along the ray; with `any`, whichever is found first.
Hit trace(World world, Ray ray, bool any) {
  Hit hit = Hit(ray.t_max, 0, 0, kNoTriangle);
  if (!(ray.t_min <= ray.t_max)) return hit;
  uint flags = (any ? gl_RayFlagsTerminateOnFirstHitEXT : 0) |
               (kSomeLetLightThrough ? 0 : gl_RayFlagsOpaqueEXT);
  rayQueryEXT query;
  rayQueryInitializeEXT(query, accelerationStructureEXT(uvec2(world.nodes)), flags, 0xff, ray.origin,
                        ray.t_min, without_zeros(ray.direction), ray.t_max);
  while (rayQueryProceedEXT(query))
    if (kSomeLetLightThrough && !passes(world, ray, query)) rayQueryConfirmIntersectionEXT(query);
  if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) return hit;
  HierarchyPart part = part_at(world, rayQueryGetIntersectionInstanceCustomIndexEXT(query, true));
  uint k = part.first_triangle[rayQueryGetIntersectionGeometryIndexEXT(query, true)] +
           uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, true));
  vec4 a = world.triangles.at[3 * k], b = world.triangles.at[3 * k + 1], c = world.triangles.at[3 * k + 2];
  // Drivers do not agree on which side is the front, and it depends on handedness: here it is known.
  vec3 normal = cross(c.xyz - a.xyz, a.xyz - b.xyz);
  float slope = dot(normal, rayQueryGetIntersectionObjectRayDirectionEXT(query, true));
  bool from_behind = (slope > 0) != (floatBitsToUint(b.w) != 0);
  vec2 uv = clamp(rayQueryGetIntersectionBarycentricsEXT(query, true), 0.0, 1.0);
  uint number = floatBitsToUint(a.w) + part.first_number;
  return Hit(rayQueryGetIntersectionTEXT(query, true), uv.x, uv.y, number | (from_behind ? kBackFace : 0));
}
