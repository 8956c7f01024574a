#include "bench/scenes_of_rays.h"

#include "luxel/import/import.h"
#include "luxel/scene/procedural.h"

namespace luxel::bench {

std::vector<NamedScene> scenes_of_rays(const std::filesystem::path& shared) {
  const auto scenes = shared / "scenes";
  return {{"Cornell box", {}},
          {"living_room", scenes / "living_room/living_room.glb"},
          {"suzanne_room", scenes / "suzanne_room/room.glb"},
          {"zdm2", scenes / "zdm2/zdm2.glb"},
          {"kaykit_city", scenes / "kaykit_city/kaykit_city.glb"}};
}

bool is_here(const NamedScene& named, Table& table) {
  if (named.file.empty() || std::filesystem::exists(named.file)) return true;
  table.notes.push_back(named.file.string() + " is not on this machine: left out");
  return false;
}

Result<scene::Scene> load(const NamedScene& named) {
  if (named.file.empty()) return scene::cornell_box();
  LUXEL_TRY(import::Imported imported, import::import_scene(named.file));
  return std::move(imported.scene);
}

}  // namespace luxel::bench
