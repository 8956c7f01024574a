#include "luxel/view/relight/save_lxr.h"

#include "luxel/base/file.h"
#include "luxel/export/edited_gltf.h"
#include "luxel/import/import.h"
#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/relight_check.h"
#include "luxel/view/free_name.h"

namespace luxel::view {
namespace {

std::vector<scene::PunctualLight> lights_to_keep(const Lamps& now) {
  std::vector<scene::PunctualLight> out;
  for (const Lamp& lamp : now.lamps) {
    out.push_back(lamp.light);
    if (!lamp.is_on) out.back().intensity = {};
  }
  return out;
}

/// B_e of a patch: where its material glowed, with the pattern that it had.
Rgb emission_to_keep(Rgb own, Rgb was, Rgb is) {
  const auto channel = [](float e, float before, float now) {
    return before > 0 ? e / before * now : kPi * now;
  };
  return {channel(own.x, was.x, is.x), channel(own.y, was.y, is.y), channel(own.z, was.z, is.z)};
}

/// Lamps of the scene are those of the file, in the same order.
export_::GltfEdits edits_of_lamps(const import::Imported& file, const Lamps& baked,
                                  const Lamps& now) {
  export_::GltfEdits out;
  out.node_of_instance = file.node_of_instance, out.node_of_light = file.node_of_light;
  for (const scene::Instance& instance : file.scene.instances)
    out.world_from_object.push_back(instance.world_from_object);
  const std::vector<scene::PunctualLight> lights = lights_to_keep(now);
  const std::vector<scene::PunctualLight>& before = file.scene.lights;
  for (uint32_t i = 0; i < lights.size(); ++i)
    if (i < before.size())
      out.lights.push_back({i, before[i], lights[i]});
    else
      out.new_lights.push_back(lights[i]);
  for (uint32_t m = 0; m < file.scene.materials.size(); ++m) {
    const scene::Material& material = file.scene.materials[m];
    scene::Material after = material;
    after.emission = emission_now(material, now, baked);
    if (after.emission != material.emission) out.materials.push_back({m, material, after});
  }
  return out;
}

}  // namespace

Result<matrix::RelightData> with_lamps(const matrix::RelightData& data, const Lamps& baked,
                                       const Lamps& now, const std::string& name) {
  matrix::RelightData out = data;
  out.lights = lights_to_keep(now);
  out.background = now.background;
  out.baked_error = 0;
  const std::vector<Rgb> is = glowing(now);
  for (size_t i = 0; i < out.size(); ++i) {
    const uint32_t m = out.material[i];
    // Patches whose glow has not changed keep their bits.
    if (is[m] != baked.glows[m].radiance)
      out.emission[i] = emission_to_keep(out.emission[i], baked.glows[m].radiance, is[m]);
  }
  if (data.scene_glb.empty()) return out;
  LUXEL_TRY(const import::Imported file,
            import::import_glb(data.scene_glb, name, {.origin = DVec3{}}));
  const export_::ReadUri none = [&](const std::string&, const std::string& what) {
    return fail(ErrorCode::bad_input, "{}: {} lies outside of it", name, what);
  };
  LUXEL_TRY(out.scene_glb,
            export_::edited_gltf(data.scene_glb, name, edits_of_lamps(file, baked, now), none));
  return out;
}

Result<std::filesystem::path> save_lxr(const LampsToSave& to_save) {
  const std::filesystem::path& from = to_save.file;
  LUXEL_TRY(const matrix::RelightData data,
            with_lamps(*to_save.data, to_save.baked, to_save.now, from.string()));
  if (const Status can_be_kept = matrix::check(data); !can_be_kept)
    return fail(ErrorCode::bad_input, "these lamps cannot be stored in a file: {}",
                can_be_kept.error().message);
  std::filesystem::path to = free_name(from.parent_path(), from.stem().string() + "-lamps", ".lxr");
  LUXEL_TRY_STATUS(write_file_atomically(to, matrix::encode_lxr(data)));
  return to;
}

}  // namespace luxel::view
