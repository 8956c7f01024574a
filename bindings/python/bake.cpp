// Bakes: `luxel bake` with its results in memory.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "bindings/python/arrays.h"
#include "bindings/python/options.h"
#include "luxel/arguments/bake_options.h"
#include "luxel/arguments/option_file.h"
#include "luxel/base/shown_text.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/solver/bake_options.h"

namespace luxel::python {
namespace {

/// Options of `luxel bake` about files that outlive a bake, which one in memory has not.
const std::set<std::string>& only_of_the_command() {
  static const std::set<std::string> flags{"--checkpoint", "--resume", "--part", "--keep"};
  return flags;
}

pipeline::BakeSettings settings_of(const std::filesystem::path& scene, const py::kwargs& options) {
  CLI::App command;
  command.set_help_flag();
  arguments::BakeChoice choice;
  choice.scene = scene;
  arguments::add_bake_settings(command, choice);
  arguments::add_bake_table(command, choice.given);
  parse(command, options, "luxel.bake");
  for (const std::string& flag : only_of_the_command())
    if (choice.given.has(flag))
      throw py::value_error(flag.substr(2) + " is for the command `luxel bake`; leave it out");
  if (!choice.settings.empty() && arguments::is_option_file(choice.settings))
    throw py::value_error(
        "settings must be the bake.json of an earlier bake; files of options are "
        "for the command `luxel bake`");
  return value_of(arguments::settings_of(choice));
}

/// A bake, how it was made, and how long that took.
struct PythonBake {
  pipeline::BakeSettings settings;
  std::unique_ptr<Progress> progress = std::make_unique<Progress>();
  pipeline::Bake bake;
};

std::shared_ptr<PythonBake> bake(const py::object& scene, const py::object& progress,
                                 const py::kwargs& options) {
  const bool is_scene = py::isinstance<scene::Scene>(scene);
  auto out = std::make_shared<PythonBake>();
  out->settings = settings_of(is_scene ? std::filesystem::path() : path_of(scene), options);
  std::optional<scene::Scene> copy;
  if (is_scene) copy = scene.cast<const scene::Scene&>();
  out->bake = value_of(run(*out->progress, progress, [&](Progress& p) {
    return is_scene ? pipeline::bake_scene(std::move(*copy), out->settings, p)
                    : pipeline::bake_scene(out->settings, p);
  }));
  warn(out->bake.warnings);
  return out;
}

/// bake.json of the bake, as text.
std::string save_files(const PythonBake& self, const std::filesystem::path& folder,
                       const py::object& callback) {
  pipeline::BakeSettings settings = self.settings;
  settings.output = folder;
  Progress saving;
  return json_text(value_of(run(saving, callback, [&](Progress& p) {
    return pipeline::save_bake(settings, self.bake, *self.progress, p);
  })));
}

const PythonBake& bake_of(const py::object& self) { return self.cast<const PythonBake&>(); }

py::array_t<float> page(const py::object& self, size_t number) {
  const pipeline::Bake& bake = bake_of(self).bake;
  if (number >= bake.lightmaps.size())
    throw py::index_error("there are " + std::to_string(bake.lightmaps.size()) + " pages");
  const image::Image& image = bake.lightmaps[number];
  return view(image.data.data(), {image.height, image.width, image.channels}, self);
}

std::vector<std::array<int, 3>> pages(const PythonBake& self) {
  std::vector<std::array<int, 3>> out;
  for (const atlas::Page& p : self.bake.atlas.pages) out.push_back({p.x, p.y, p.side});
  if (out.empty()) out.push_back({0, 0, self.bake.atlas.resolution});
  return out;
}

py::array_t<uint8_t> preview(const py::object& self) {
  const image::Image8& image = bake_of(self).bake.preview;
  return view(image.data.data(), {image.height, image.width, image.channels}, self);
}

py::array_t<float> corners(const py::object& self) {
  static_assert(sizeof(std::array<Vec2, 3>) == 6 * sizeof(float));
  const atlas::Atlas& atlas = bake_of(self).bake.atlas;
  return view(reinterpret_cast<const float*>(atlas.corners.data()),
              {py::ssize_t(atlas.corners.size()), 3, 2}, self);
}

/// kNone becomes -1: there are fewer than 2^31 texels.
py::array_t<int32_t> texel_map(const py::object& self) {
  const atlas::TexelMap& map = bake_of(self).bake.map;
  return view(reinterpret_cast<const int32_t*>(map.texel_at.data()),
              {map.resolution, map.resolution}, self);
}

/// The fields of atlas::Texel that are not bits.
py::dtype texel_type() {
  constexpr size_t kSample = offsetof(atlas::Texel, sample);
  constexpr size_t kInstance = kSample + offsetof(scene::SurfacePoint, instance),
                   kTriangle = kSample + offsetof(scene::SurfacePoint, triangle),
                   kAt = kSample + offsetof(scene::SurfacePoint, at);
  py::list names, formats, offsets;
  const auto add = [&](const char* name, const py::object& format, size_t offset) {
    names.append(name), formats.append(format), offsets.append(offset);
  };
  add("x", py::dtype::of<uint16_t>(), offsetof(atlas::Texel, x));
  add("y", py::dtype::of<uint16_t>(), offsetof(atlas::Texel, y));
  add("instance", py::dtype::of<uint32_t>(), kInstance);
  add("triangle", py::dtype::of<uint32_t>(), kTriangle);
  add("barycentric", py::make_tuple(py::dtype::of<float>(), py::make_tuple(2)), kAt);
  return {names, formats, offsets, sizeof(atlas::Texel)};
}

py::array texels(const py::object& self) {
  const auto& all = bake_of(self).bake.map.texels;
  py::array out(texel_type(), {py::ssize_t(all.size())}, {py::ssize_t(sizeof(atlas::Texel))},
                all.data(), self);
  out.attr("setflags")(py::arg("write") = false);
  return out;
}

/// Where the texels' samples lie [m]: (n, 3).
py::array_t<float> positions(const PythonBake& self) {
  const auto& all = self.bake.map.texels;
  py::array_t<float> out({py::ssize_t(all.size()), py::ssize_t(3)});
  float* at = out.mutable_data();
  for (const atlas::Texel& texel : all) {
    const Vec3 p = scene::world_position(self.bake.scene, texel.sample);
    *at++ = p.x, *at++ = p.y, *at++ = p.z;
  }
  return out;
}

py::array_t<float> irradiance(const py::object& self) {
  const std::vector<Rgb>& light = bake_of(self).bake.light.irradiance;
  return view_of_vectors(light.data(), light.size(), self);
}

py::object error(const py::object& self) {
  const std::vector<float>& errors = bake_of(self).bake.light.errors;
  if (errors.empty()) return py::none();
  return view(errors.data(), {py::ssize_t(errors.size())}, self);
}

py::list options_of_bake() {
  std::vector<Described> out;
  describe_all(pipeline::bake_options(), {}, only_of_the_command(), out);
  return list_of(out);
}

void add_arrays(py::class_<PythonBake, std::shared_ptr<PythonBake>>& type) {
  type.def_property_readonly(
          "lightmap", [](const py::object& self) { return page(self, 0); },
          "Irradiance [W/m^2] and coverage of the first page, (side, side, 4). Row 0 is v = 0.")
      .def("page", &page, py::arg("number"), "The lightmap of a page, as `lightmap`.")
      .def_property_readonly("pages", &pages,
                             "x, y and side of each page [texels] in texel_map, which has all.")
      .def_property_readonly(
          "texel_map", &texel_map,
          "The row of `texels` at each place of the map, -1 for none, (side, side).")
      .def_property_readonly(
          "texels", &texels,
          "A structured array of all texels: their place in the map (x, y), and the instance, "
          "triangle and barycentric coordinates of their sample on `scene`.")
      .def_property_readonly("positions", &positions,
                             "Where each texel's sample lies in the world [m], (n, 3). A copy.")
      .def_property_readonly("irradiance", &irradiance, "Irradiance of each texel [W/m^2], (n, 3).")
      .def_property_readonly(
          "error", &error,
          "The standard error of each texel's luminance, relative to itself or, where it is "
          "darker, to a tenth of the mean; None where the solver does not know it.")
      .def_property_readonly("texel_corners", &corners,
                             "Where the corners of scene.triangles lie in the map [texels], "
                             "(n, 3, 2).")
      .def_property_readonly("preview", &preview,
                             "A picture of the scene, (height, width, 3), sRGB.");
}

}  // namespace

void add_bake(py::module_& module) {
  py::class_<PythonBake, std::shared_ptr<PythonBake>> type(
      module, "Bake", py::is_final(),
      "The light of a scene. Its arrays are views, which cannot be written.");
  add_arrays(type);
  type.def_property_readonly(
          "scene", [](const PythonBake& self) { return self.bake.scene; },
          "The scene as it was baked, with its outside light; charts may have been cut. A copy.")
      .def_property_readonly(
          "relative_error",
          [](const PythonBake& self) {
            const pipeline::TexelLight& light = self.bake.light;
            return light.delivered_error.value_or(light.relative_error);
          },
          "Estimated root mean square error over the mean light.")
      .def_property_readonly(
          "warnings", [](const PythonBake& self) { return self.bake.warnings; },
          "Warnings, one sentence each.")
      .def("_save", &save_files)
      .def("__repr__", [](const PythonBake& self) {
        return fmt::format("<luxel.Bake: {} x {} texels, {} of them on surfaces>",
                           self.bake.map.resolution, self.bake.map.resolution,
                           self.bake.map.texels.size());
      });
  module.def("bake", &bake, py::arg("scene"), py::kw_only(), py::arg("progress") = py::none(),
             "Bakes a Scene or the scene in a file, with the options of `luxel bake`.");
  module.def("_options_of_bake", &options_of_bake);
}

}  // namespace luxel::python
