// luxel bench rebake: what a bake after an edit costs that builds on one that is kept.
#include <cmath>
#include <functional>

#include "bench/bake_files.h"
#include "bench/bench.h"
#include "luxel/base/parallel.h"
#include "luxel/export/baked_glb.h"
#include "luxel/import/import.h"

namespace luxel::bench {
namespace {

constexpr int kRebakeRounds = 2, kRebakeResolution = 1024;

struct Edit {
  const char* name;
  std::function<void(scene::Scene&)> apply;
};

struct EditedScene {
  const char* file;
  const char* moved;  ///< an instance that stands in the room
  Vec3 by;            ///< [m]
  Vec3 lamp;          ///< where one hangs besides sun and sky [m]
};
const std::array kScenes{
    EditedScene{"living_room/living_room.glb", "Cylinder", {0.3f, 0, 0}, {0, 2, 0}},
    EditedScene{"suzanne_room/room.glb", "Sphere.004", {-0.5f, 0, 0}, {0, 3, 0}}};

std::vector<Edit> edits_of(const EditedScene& s) {
  const auto move = [&s](scene::Scene& scene) {
    for (scene::Instance& instance : scene.instances)
      if (instance.name == s.moved)
        for (size_t axis = 0; axis < 3; ++axis)
          instance.world_from_object.row[axis][3] += s.by[int(axis)];
  };
  return {{"nothing", [](scene::Scene&) {}},
          {"lamp dimmed", [](scene::Scene& scene) { scene.lights[0].intensity *= 0.5f; }},
          {"lamp moved", [](scene::Scene& scene) { scene.lights[0].position.x += 0.2f; }},
          {"painted",
           [](scene::Scene& scene) {
             scene.materials[0].base_color = scene.materials[0].base_color * Rgb{0.9f, 0.5f, 0.5f};
           }},
          {"moved", move}};
}

Status write_scene(const std::filesystem::path& from, const EditedScene& s, const Edit& edit,
                   const std::filesystem::path& to) {
  LUXEL_TRY(import::Imported imported, import::import_scene(from));
  scene::PunctualLight lamp;
  lamp.name = "lamp", lamp.position = s.lamp, lamp.intensity = {800, 700, 500};
  imported.scene.lights = {lamp};
  edit.apply(imported.scene);
  LUXEL_TRY(const std::vector<std::byte> glb, export_::scene_glb(imported.scene));
  return write_file_atomically(to, glb);
}

/// Root mean square over the mean, at texels that both have.
Result<double> difference(const std::filesystem::path& a, const std::filesystem::path& b) {
  LUXEL_TRY(const image::Image p, exr_at(a / "lightmap.exr"));
  LUXEL_TRY(const image::Image q, exr_at(b / "lightmap.exr"));
  double sum2 = 0, mean = 0, count = 0;
  for (int y = 0; y < q.height; ++y)
    for (int x = 0; x < q.width; ++x) {
      if (p.at(x, y)[3] < 1 || q.at(x, y)[3] < 1) continue;
      const double truth = double(luminance(q.rgb(x, y)));
      const double d = double(luminance(p.rgb(x, y))) - truth;
      sum2 += d * d, mean += truth, ++count;
    }
  return mean > 0 ? std::sqrt(sum2 * count) / mean : 0;
}

Status measure(const std::filesystem::path& shared, const EditedScene& s, int resolution,
               int threads, Table& table) {
  const auto file = shared / "scenes" / s.file;
  if (!std::filesystem::exists(file)) {
    table.notes.push_back(file.string() + " is not on this machine: left out");
    return {};
  }
  // A bake of the scene as it was, which is kept.
  const TemporaryFolder folder("luxel-bench-rebake");
  const std::vector<Edit> edits = edits_of(s);
  pipeline::BakeSettings settings;
  settings.scene = folder.path / "scene.glb";
  settings.resolution = resolution, settings.threads = threads;
  LUXEL_TRY(settings.outside.sky, pipeline::parse_sky("135,45"));
  settings.output = folder.path / "kept", settings.keep = true;
  LUXEL_TRY_STATUS(write_scene(file, s, edits[0], settings.scene));
  LUXEL_TRY(const TimedFiles kept, timed_files(settings));
  // After each edit: from scratch and from what is kept, in turn.
  for (const Edit& edit : edits) {
    LUXEL_TRY_STATUS(write_scene(file, s, edit, settings.scene));
    TimedFiles scratch, again;
    for (int round = 0; round < kRebakeRounds; ++round) {
      settings.output = folder.path / "scratch", settings.keep = false;
      LUXEL_TRY_STATUS(time_again(settings, scratch));
      settings.output = folder.path / "kept", settings.keep = true;
      LUXEL_TRY_STATUS(time_again(settings, again));
    }
    LUXEL_TRY(const double error, difference(folder.path / "kept", folder.path / "scratch"));
    const double rays = scratch.report["counts"]["rays"], ratio = scratch.seconds / again.seconds;
    const double traced = again.report["cache"]["rays_traced"].get<double>() / rays;
    const std::string name = std::filesystem::path(s.file).parent_path().string();
    table.rows.push_back(
        {fmt::format("{0}, {1} x {1}", name, resolution), edit.name,
         fmt::format("{:.2f}", kept.seconds), fmt::format("{:.2f}", scratch.seconds),
         fmt::format("{:.2f}", again.seconds), fmt::format("{:.1f}", ratio),
         fmt::format("{:.1f} %", 100 * traced), fmt::format("{:.3f} %", 100 * error)});
    table.json.push_back({{"scene", name},
                          {"resolution", resolution},
                          {"edit", edit.name},
                          {"seconds_to_keep", kept.seconds},
                          {"seconds_from_scratch", scratch.seconds},
                          {"seconds", again.seconds},
                          {"ratio", ratio},
                          {"rays", traced},
                          {"difference", error}});
  }
  return {};
}

}  // namespace

Result<Table> measure_rebake(const std::filesystem::path& shared, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table("rebake", {"scene", "edit", "bake that is kept, s", "from scratch, s",
                                     "with --keep, s", "ratio", "rays traced", "difference"});
  for (const EditedScene& s : kScenes)
    LUXEL_TRY_STATUS(measure(shared, s, kRebakeResolution, threads, table));
  table.notes.push_back(fmt::format(
      "Sun, sky and a lamp; 256 samples, all bounces, files included. Seconds are the best of {} "
      "rounds in turn, but for the bake that is kept. The difference is that of the lightmaps' "
      "luminance, root mean square over the mean; with another layout it would be larger.",
      kRebakeRounds));
  return table;
}

}  // namespace luxel::bench
