#include "luxel/solve/gather/trace/near_paths.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/off_surface.h"
#include "luxel/transport/elements.h"
#include "luxel/transport/texel_width.h"

namespace luxel::gather {
namespace {

/// A ray that has ended nearer than a texel there is wide asks for more than the map knows.
constexpr float kNearTexels = 1;
/// Paths that carry more are never ended by chance, which would be noise where light is even.
constexpr float kSureThroughput = 0.1f;

/// The side of the surface that a ray has met; the back is that of the flat triangle.
transport::SmoothPoint place_of(const scene::Scene& scene, const trace::Hit& hit) {
  if (!hit.back_face) return transport::smooth_point(scene, hit.point());
  const scene::Facet facet = scene::facet_of(scene, hit.instance, hit.triangle);
  const Vec3 back = -facet.front;
  return {scene::world_position(scene, hit.point()), scene::off_surface(facet, hit.at, back),
          -scene::shading_normal(scene, hit.point(), facet.front), back};
}

/// A path that brings nothing more.
void end(NearPath path, NearBuffers& buffers) {
  path.throughput = {};
  buffers.going_on.push_back(path);
}

/// The light that lights send to where the paths are.
uint64_t add_direct_light(const NearScene& in, NearBuffers& buffers) {
  buffers.light.resize(buffers.receivers.size());
  light::direct_light_at({in.scene, in.lights, in.tracer}, {.samples = 1}, buffers.receivers,
                         buffers.batch, buffers.light);
  for (size_t i = 0; i < buffers.paths.size(); ++i) {
    NearPath& path = buffers.paths[i];
    path.light += path.throughput * buffers.light[i].irradiance / kPi;
    if (in.layers)
      light::add_light_by_layer(
          buffers.batch, i, *in.layers, path.throughput * (weight_of(path) / kPi),
          buffers.by_layer.subspan(path.element * in.layers->size(), in.layers->size()));
  }
  return buffers.batch.rays.size();
}

}  // namespace

std::vector<float> texel_widths_m(const scene::Scene& scene, const atlas::Atlas& atlas) {
  std::vector<float> width(atlas.corners.size());
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const size_t count = scene.meshes[scene.instances[i].mesh].triangles.size();
    parallel_for(count, 4096, [&](size_t begin, size_t end) {
      for (uint32_t t = uint32_t(begin); t < end; ++t) {
        width[atlas.triangle_number(i, t)] = transport::texel_width_m(scene, atlas, i, t);
      }
    });
  }
  return width;
}

float near_m(const NearScene& in, const trace::Hit& hit) {
  return kNearTexels * in.texel_width_m[in.atlas.triangle_number(hit.instance, hit.triangle)];
}

MapAnswers map_answers(const NearScene& in, const trace::Hit& hit) {
  const scene::Material& material = scene::material_at(in.scene, hit.point());
  // A surface that scatters light through shines by the light behind it, which the map knows.
  if (material.diffuse_transmission > 0) return MapAnswers::yes;
  if (hit.back_face)
    return scene::reflects_from_behind(material) ? MapAnswers::no : MapAnswers::yes;
  if (hit.t < near_m(in, hit)) return MapAnswers::no;
  return in.sides ? MapAnswers::where_own : MapAnswers::yes;
}

bool goes_on(const NearScene& in, const NearPath& path) {
  if (!path.hit.found() || max_component(path.throughput) <= 0) return false;
  const MapAnswers answers = map_answers(in, path.hit);
  return answers == MapAnswers::no || (answers == MapAnswers::where_own &&
                                       !transport::has_own_texel(*in.sides, path.hit.point()));
}

bool reflect(const NearScene& in, NearPath& path) {
  path.throughput = path.throughput * scene::reflectance_at(in.scene, path.hit.point());
  return max_component(path.throughput) > 0;
}

light::Receiver receiver_of(const NearScene& in, uint64_t depth, NearPath& path) {
  const transport::SmoothPoint p = place_of(in.scene, path.hit);
  const light::Receiver out{p.start, p.normal, p.geometric_normal,
                            hash64(path.seed + depth, path.sample ^ 0x80000000u)};
  if (depth == 0)
    path.first_m =
        path.hit.t + length(out.position - scene::world_position(in.scene, path.hit.point()));
  return out;
}

bool go_on(const light::Receiver& at, uint64_t depth, NearPath& path) {
  RandomStream random{hash64(path.seed + depth, path.sample)};
  const float chance = std::min(1.0f, max_component(path.throughput) / kSureThroughput);
  if (random.next() >= chance) return false;
  path.throughput = path.throughput / chance;
  path.direction = frame_around(at.normal).to_world(cosine_hemisphere_sample(random.next2()));
  path.direction = light::mirrored_above(path.direction, at.geometric_normal);
  return true;
}

uint64_t step_near(const NearScene& in, uint64_t depth, NearBuffers& buffers) {
  buffers.receivers.clear(), buffers.rays.clear(), buffers.going_on.clear();
  // Paths on black surfaces end.
  std::erase_if(buffers.paths, [&](NearPath& path) {
    const bool goes = reflect(in, path);
    if (!goes) end(path, buffers);
    return !goes;
  });
  // Light straight from the lights, at the points that the others have met.
  for (NearPath& path : buffers.paths) buffers.receivers.push_back(receiver_of(in, depth, path));
  const uint64_t shadow_rays = add_direct_light(in, buffers);
  // Each path goes on with one ray, or ends by chance.
  size_t alive = 0;
  for (size_t i = 0; i < buffers.paths.size(); ++i) {
    NearPath& path = buffers.paths[i];
    if (!go_on(buffers.receivers[i], depth, path)) {
      end(path, buffers);
      continue;
    }
    buffers.rays.push_back({buffers.receivers[i].position, 0, path.direction, INFINITY});
    buffers.paths[alive++] = path;
  }
  buffers.paths.resize(alive);
  buffers.hits.resize(alive);
  in.tracer.closest_hits(buffers.rays, buffers.hits);
  // Glass on the way colours what the path carries.
  buffers.tint.assign(alive, {1, 1, 1});
  if (in.tracer.has_tints()) in.tracer.tint(buffers.rays, buffers.hits, buffers.tint);
  for (size_t i = 0; i < alive; ++i) {
    buffers.paths[i].hit = buffers.hits[i];
    buffers.paths[i].throughput = buffers.paths[i].throughput * buffers.tint[i];
    buffers.going_on.push_back(buffers.paths[i]);
  }
  return shadow_rays + alive;
}

}  // namespace luxel::gather
