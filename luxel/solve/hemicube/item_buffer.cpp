#include "luxel/solve/hemicube/item_buffer.h"

#include <algorithm>

#include "luxel/viewfactor/hemicube.h"

namespace luxel::hemicube {
namespace {

/// Rays between two looks at Progress.
constexpr size_t kRaysAtATime = 16384;

Item item_of(const Senders& s, const trace::Hit& hit) {
  if (!hit.found()) return {SeenKind::surroundings, {}};
  const bool is_back = hit.back_face;
  const bool is_black = is_back && !scene::reflects_from_behind(material_at(s.scene, hit.point()));
  return {is_black ? SeenKind::back : SeenKind::surface, locate(s.mesh, hit.point()), is_back};
}

}  // namespace

Frame frame_of_cube(Vec3 normal) {
  constexpr float kCosine = 0.90630779f, kSine = 0.42261826f;  // 25 degrees
  const Frame f = frame_around(normal);
  return {f.tangent * kCosine + f.bitangent * kSine, f.bitangent * kCosine - f.tangent * kSine,
          normal};
}

Result<ItemBuffer> item_buffer(const Senders& senders, const Viewpoint& from, int resolution,
                               Progress& progress) {
  LUXEL_TRY(viewfactor::Hemicube cube, viewfactor::make_hemicube(resolution, progress));
  ItemBuffer out{resolution, std::vector<Item>(cube.direction.size()), std::move(cube.direction),
                 std::move(cube.delta_factor)};
  const Frame frame = frame_of_cube(from.normal);
  for (Vec3& direction : out.direction) direction = frame.to_world(direction);
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<size_t> pixels;  // of the rays
  progress.begin("item buffer", out.items.size());
  for (size_t first = 0; first < out.items.size(); first += kRaysAtATime) {
    LUXEL_TRY_STATUS(stopped(progress));
    rays.clear(), pixels.clear();
    const size_t end = std::min(first + kRaysAtATime, out.items.size());
    for (size_t i = first; i < end; ++i) {
      if (dot(out.direction[i], from.geometric_normal) <= 0) continue;
      rays.push_back({from.position, 0, out.direction[i], INFINITY});
      pixels.push_back(i);
    }
    hits.resize(rays.size());
    senders.tracer.closest_hits(rays, hits, trace::Packets::bundles);
    for (size_t k = 0; k < hits.size(); ++k) out.items[pixels[k]] = item_of(senders, hits[k]);
    progress.advance(end - first);
  }
  return out;
}

}  // namespace luxel::hemicube
