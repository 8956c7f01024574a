#include "luxel/view/edit/save_scene.h"

#include <algorithm>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/export/edited_gltf.h"
#include "luxel/import/gltf_images.h"
#include "luxel/import/import.h"
#include "luxel/view/edit/sky_sun.h"
#include "luxel/view/free_name.h"

namespace luxel::view {
namespace {

/// As the file is to have it.
scene::PunctualLight light_to_save(const EditedLamp& lamp) {
  scene::PunctualLight out = lamp.light;
  if (!lamp.is_on) out.intensity = {};
  return out;
}

bool differ(const scene::PunctualLight& a, const scene::PunctualLight& b) {
  return a.intensity != b.intensity || a.position != b.position || a.direction != b.direction ||
         a.side != b.side || a.inner_cone_rad != b.inner_cone_rad ||
         a.outer_cone_rad != b.outer_cone_rad || a.angular_radius_rad != b.angular_radius_rad;
}

export_::GltfEdits edits_of(const SceneToSave& to_save, const import::Imported& file) {
  const scene::Scene& read = to_save.read->scene;
  const SceneNow& now = to_save.now;
  export_::GltfEdits out;
  out.node_of_instance = file.node_of_instance, out.node_of_light = file.node_of_light;
  out.origin = read.origin, out.object_origin = file.object_origin;
  for (uint32_t i = 0; i < read.instances.size(); ++i) {
    const Mat34& before = read.instances[i].world_from_object;
    out.world_from_object.push_back(before);
    if (now.world_from_object[i] != before) out.placed.push_back({i, now.world_from_object[i]});
  }
  for (uint32_t i = 0; i < now.lamps.size(); ++i) {
    const EditedLamp& lamp = now.lamps[i];
    const scene::PunctualLight light = light_to_save(lamp);
    const bool is_changed = i >= read.lights.size() || differ(light, read.lights[i]);
    if (i < file.scene.lights.size() && lamp.is_deleted)
      out.deleted_lights.push_back(i);
    else if (i < file.scene.lights.size() && is_changed)
      out.lights.push_back({i, read.lights[i], light});
    else if (i >= file.scene.lights.size() && is_changed && !lamp.is_deleted &&
             !is_of_sky(i, *to_save.read, now))
      out.new_lights.push_back(light);
  }
  for (uint32_t m = 0; m < read.materials.size(); ++m) {
    scene::Material after = read.materials[m];
    after.base_color = now.materials[m].base_color, after.emission = now.materials[m].emission;
    after.metallic = now.materials[m].metallic;
    if (now.materials[m] != look_of(read.materials[m]))
      out.materials.push_back({m, read.materials[m], std::move(after)});
  }
  return out;
}

/// A scene of another format with the edits in it.
scene::Scene with_edits(scene::Scene file, const export_::GltfEdits& edits) {
  for (const auto& placed : edits.placed)
    file.instances[placed.instance].world_from_object = placed.world_from_object;
  for (const auto& material : edits.materials) {
    file.materials[material.material].base_color = material.now.base_color;
    file.materials[material.material].emission = material.now.emission;
    file.materials[material.material].metallic = material.now.metallic;
  }
  for (const auto& light : edits.lights) file.lights[light.light] = light.now;
  for (size_t k = edits.deleted_lights.size(); k-- > 0;)
    file.lights.erase(file.lights.begin() + edits.deleted_lights[k]);
  file.lights.insert(file.lights.end(), edits.new_lights.begin(), edits.new_lights.end());
  return file;
}

Result<std::vector<std::byte>> gltf_bytes(const SceneToSave& to_save,
                                          const export_::GltfEdits& edits) {
  const std::filesystem::path& path = to_save.settings.scene;
  const import::ImportParams& reading = to_save.settings.reading;
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(path));
  const import::SceneFiles files{path.parent_path(), reading.search_paths, reading.trust_paths};
  import::ReadingMemory memory(to_save.settings.max_memory_bytes);
  return export_::edited_gltf(
      bytes, path.string(), edits, [&](const std::string& uri, const std::string& what) {
        return import::read_named_file(files, import::decoded_uri(uri), what, memory);
      });
}

/// True: the file is still the one that was read, with instances where they were, as many
/// materials, and no more lights.
bool is_as_read(const scene::Scene& file, const scene::Scene& read) {
  const auto is_there = [](const scene::Instance& a, const scene::Instance& b) {
    return a.world_from_object == b.world_from_object && a.name == b.name && a.mesh == b.mesh;
  };
  return std::ranges::equal(file.instances, read.instances, is_there) &&
         file.materials.size() == read.materials.size() && file.lights.size() <= read.lights.size();
}

}  // namespace

Result<std::filesystem::path> save_scene(const SceneToSave& to_save) {
  const pipeline::BakeSettings& settings = to_save.settings;
  import::ImportParams reading = settings.reading;
  reading.origin = to_save.read->scene.origin;
  LUXEL_TRY(import::Imported file,
            import::import_scene(settings.scene, reading, settings.max_memory_bytes));
  if (!is_as_read(file.scene, to_save.read->scene))
    return fail(ErrorCode::bad_input,
                "{} has changed since it was read, so the edited scene cannot be saved; restore "
                "the file, or open it again",
                settings.scene.string());
  const export_::GltfEdits edits = edits_of(to_save, file);
  const bool is_gltf = !file.node_of_instance.empty();
  std::vector<std::byte> bytes;
  if (is_gltf) {
    LUXEL_TRY(bytes, gltf_bytes(to_save, edits));
  } else {
    LUXEL_TRY(bytes, export_::scene_glb(with_edits(std::move(file.scene), edits)));
  }
  std::error_code error;
  std::filesystem::create_directories(settings.output, error);
  if (error)
    return fail(ErrorCode::io, "cannot create {}: {}", settings.output.string(), error.message());
  const std::filesystem::path to =
      free_name(settings.output, settings.scene.stem().string() + "-edited",
                is_gltf ? settings.scene.extension().string() : ".glb");
  LUXEL_TRY_STATUS(write_file_atomically(to, bytes));
  return to;
}

std::string what_sky_lacks(const SceneToSave& to_save) {
  if (!to_save.now.sky) return "";
  return is_of_sky(to_save.read->sun->light, *to_save.read, to_save.now)
             ? fmt::format("; a scene file cannot store the sky: open it with --sky {}",
                           to_save.now.sky->words)
             : "; a scene file cannot store the sky: only its sun is there";
}

}  // namespace luxel::view
