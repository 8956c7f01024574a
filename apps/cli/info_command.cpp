#include "apps/cli/cli.h"
#include "apps/cli/machine.h"
#include "apps/cli/print.h"
#include "luxel/base/shown_text.h"
#include "luxel/gpu/device.h"
#include "luxel/import/import.h"
#include "luxel/scene/origin.h"
#include "luxel/scene/scene.h"

namespace luxel::cli {
namespace {

struct InfoOptions {
  Common common;
  Given reading;
  std::string scene;
  bool devices = false;
};

nlohmann::json describe(const scene::Scene& scene, const std::vector<std::string>& warnings) {
  size_t emissive = 0, drawn = 0, stored = 0;
  double area = 0;
  bool uv1 = !scene.meshes.empty();
  for (const scene::Mesh& mesh : scene.meshes) {
    stored += mesh.triangles.size();
    uv1 = uv1 && !mesh.uv1.empty();
  }
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    drawn += mesh.triangles.size();
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      area += double(scene::area_m2(scene::world_triangle(scene, i, t)));
      emissive += max_component(scene.materials[mesh.triangle_material[t]].emission) > 0;
    }
  }
  const Box3 box = scene::world_bounds(scene);
  return {{"triangles", drawn},
          {"triangles_stored", stored},
          {"emissive_triangles", emissive},
          {"meshes", scene.meshes.size()},
          {"instances", scene.instances.size()},
          {"materials", scene.materials.size()},
          {"textures", scene.textures.size()},
          {"lights", scene.lights.size()},
          {"cameras", scene.cameras.size()},
          {"area_m2", area},
          {"bounds",
           {point_json(scene::in_world(scene, box.lower)),
            point_json(scene::in_world(scene, box.upper))}},
          {"origin", point_json(scene.origin)},
          {"has_texcoord_1", uv1},
          {"warnings", warnings}};
}

/// Without Vulkan, or without a device, the list is empty: luxel needs none.
int run_devices(const InfoOptions& options) {
  const auto devices = gpu::list_devices();
  if (options.common.json) {
    nlohmann::json json{{"devices", nlohmann::json::array()}};
    if (!devices) json["reason"] = devices.error().message;
    for (const gpu::DeviceInfo& d : devices.value_or(std::vector<gpu::DeviceInfo>{}))
      json["devices"].push_back({{"name", d.name},
                                 {"kind", kind_of(d.type)},
                                 {"lacks", d.lacks},
                                 {"ray_queries", d.has_ray_queries}});
    print_json(stdout, json);
    return kDone;
  }
  if (!devices) {
    print_line(stdout, "no device: " + devices.error().message);
    return kDone;
  }
  for (size_t i = 0; i < devices->size(); ++i) {
    const gpu::DeviceInfo& d = (*devices)[i];
    const std::string use =
        d.lacks.empty() ? fmt::format("; luxel bake --device gpu:{} and luxel-view can use it", i)
                        : "; luxel cannot use it: it lacks " + d.lacks;
    print_line(stdout, fmt::format("{}: {}{}{}", d.name, kind_of(d.type),
                                   d.has_ray_queries ? ", with ray queries" : "", use));
  }
  return kDone;
}

int run_info(const InfoOptions& options) {
  if (options.devices) return run_devices(options);
  import::ImportParams reading;
  if (const Status read = read_given(options.reading, pipeline::import_options(), reading); !read)
    return report(read.error(), options.common);
  const auto imported = import::import_scene(options.scene, reading);
  if (!imported) return report(imported.error(), options.common);
  const nlohmann::json json = describe(imported->scene, imported->warnings);
  if (options.common.json) {
    print_json(stdout, json);
    return kDone;
  }
  print_warnings(imported->warnings, options.common);
  for (const auto& [key, value] : json.items())
    if (key != "warnings") print_line(stdout, fmt::format("{:20} {}", key, json_text(value)));
  return kDone;
}

}  // namespace

void register_info(CLI::App& app, Action& action) {
  CLI::App* info = app.add_subcommand("info", "Describe a scene, or list the graphics devices");
  auto options = std::make_shared<InfoOptions>();
  CLI::Option* scene = info->add_option("SCENE", options->scene, "glTF, OBJ, FBX, ... file");
  info->add_flag("--devices", options->devices,
                 "List the graphics devices of this machine and whether luxel can use them")
      ->excludes(scene);
  add_import(*info, options->reading);
  add_common(*info, options->common);
  info->callback([options, &action] {
    if (!options->devices && options->scene.empty()) throw CLI::RequiredError("SCENE");
    action = [options] { return run_info(*options); };
  });
}

}  // namespace luxel::cli
