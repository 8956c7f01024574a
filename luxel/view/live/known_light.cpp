#include "luxel/view/live/known_light.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"

namespace luxel::view {
namespace {

constexpr size_t kGrain = 4096;

std::vector<Place> placed(const KnownLight& known, std::span<const Mat34> world_from_object) {
  std::vector<Place> out(known.places.size());
  parallel_for(out.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Mat34& to_world = world_from_object[known.map.texels[i].sample.instance];
      const Vec3 normal = transform_normal(to_world, known.places[i].normal);
      const float size = length(normal);
      out[i].position = transform_point(to_world, known.places[i].position);
      out[i].normal = size > 0 ? normal / size : Vec3{0, 1, 0};
    }
  });
  return out;
}

/// Relative changes of drafts that may be noise, and those that are the edit's.
constexpr float kNoise = 0.05f, kEdit = 0.2f;

/// What is known keeps its sharp edges where a draft changes little. Where it changes much, edges
/// of shadows that were there would stay behind: the draft itself takes its place.
Rgb after_edit(Rgb known, Rgb drafted_before, Rgb drafted) {
  const float most = std::max(max_component(drafted_before), max_component(drafted));
  if (!(most > 0)) return known;
  const Rgb by = drafted - drafted_before;
  const float change = std::max({std::abs(by.x), std::abs(by.y), std::abs(by.z)}) / most;
  const float share = std::clamp((change - kNoise) / (kEdit - kNoise), 0.0f, 1.0f);
  return max((known + by) * (1 - share) + drafted * share, Rgb{});
}

}  // namespace

KnownLight known_light(const light::TexelScene& in, const Draft& draft) {
  KnownLight out;
  out.atlas = in.atlas, out.map = in.map;
  out.places.resize(in.map.texels.size());
  std::vector<Mat34> world_from_object;
  for (const scene::Instance& instance : in.scene.instances)
    world_from_object.push_back(instance.world_from_object);
  parallel_for(out.places.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const scene::SurfacePoint& at = in.map.texels[i].sample;
      const scene::Mesh& mesh = in.scene.meshes[in.scene.instances[at.instance].mesh];
      const auto& [a, b, c] = mesh.triangles[at.triangle];
      const Vec3 pa = mesh.positions[a], pb = mesh.positions[b], pc = mesh.positions[c];
      out.places[i] = {interpolate(pa, pb, pc, at.at), cross(pb - pa, pc - pa)};
    }
  });
  out.drafted = light_of_draft(draft, draft.irradiance, placed(out, world_from_object));
  return out;
}

std::vector<Rgb> light_after_edit(const KnownLight& known, const Draft& edited,
                                  std::span<const Mat34> world_from_object) {
  std::vector<Rgb> out =
      light_of_draft(edited, edited.irradiance, placed(known, world_from_object));
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = after_edit(known.irradiance[i], known.drafted[i], out[i]);
  return out;
}

}  // namespace luxel::view
