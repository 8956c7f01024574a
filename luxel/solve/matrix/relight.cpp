#include "luxel/solve/matrix/relight.h"

#include <algorithm>

#include "luxel/base/share_out.h"
#include "luxel/solve/matrix/make_codec.h"
#include "luxel/solve/matrix/trials.h"

namespace luxel::matrix {
namespace {

void take_patches(const Patches& patches, RelightData& out) {
  out.position = copied(patches.elements.position);
  out.normal = copied(patches.elements.normal);
  out.reflectance = copied(patches.elements.reflectance);
  out.area_m2 = patches.area_m2, out.emission = patches.emission, out.material = patches.material;
  for (size_t i = 0; i < patches.size(); ++i) {
    out.first_probe.push_back(uint32_t(out.probe.size()));
    for (size_t k = 0; k < patches.probes_of(i); ++k) out.probe.push_back(patches.probe(i, k));
  }
  out.first_probe.push_back(uint32_t(out.probe.size()));
}

/// All triangles in the world. Those whose material has holes block like any other.
Occluders occluders_of(const scene::Scene& scene) {
  Occluders out;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    const auto base = uint32_t(out.position.size());
    for (const Vec3 p : mesh.positions)
      out.position.push_back(transform_point(instance.world_from_object, p));
    for (const auto& t : mesh.triangles)
      out.triangle.push_back({base + t[0], base + t[1], base + t[2]});
  }
  return out;
}

}  // namespace

Result<RelightData> make_relight_data(const scene::Scene& scene, const trace::RayTracer& tracer,
                                      Target target, const RelightParams& params,
                                      Progress& progress, Team* team) {
  for (const scene::PunctualLight& light : scene.lights)
    if (light.profile != scene::kNone)
      return fail(ErrorCode::bad_setting,
                  "light '{}' has a light profile, which .lxr files do not keep; leave it out",
                  light.name);
  LUXEL_TRY(const Prepared prepared,
            prepare(scene, tracer, {.patches = params.patches, .factors = params.factors}, progress,
                    team));
  LUXEL_TRY_STATUS(leave_rest_to_first(team));
  const Patches& patches = prepared.patched.patches;
  RelightData out;
  take_patches(patches, out);
  out.sky = prepared.sky, out.bounces = params.bounces;
  out.lights = scene.lights, out.background = scene.background;
  for (const scene::Material& m : scene.materials) out.material_name.push_back(m.name);
  progress.begin("coarse scene", 0);
  const CoarseScene coarse =
      make_coarse_scene(prepared.factors, prepared.patched.tree, patches.area_m2,
                        patches.elements.reflectance, kCoarseClusters);
  LUXEL_TRY(out.glow, make_glow(scene, tracer, prepared, params.patches.seed, progress));
  LUXEL_TRY(const Trials trials,
            make_trials(scene, tracer, prepared, coarse,
                        {.bounces = params.bounces, .seed = params.patches.seed, .glow = &out.glow},
                        progress));
  LUXEL_TRY(MadeCodec made, make_codec({prepared, coarse, trials}, params, progress));
  out.codec = std::move(made.codec);
  out.usual_codec_error = usual_error(trials, made.errors);
  out.codec_error = largest_error(trials, made.errors);
  LUXEL_TRY(target.transfer, make_transfer(prepared.patched, tracer,
                                           {target.position, target.geometric_normal}, progress));
  out.target = std::move(target);
  out.occluders = occluders_of(scene);
  out.origin = scene.origin;
  return out;
}

}  // namespace luxel::matrix
