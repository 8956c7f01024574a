// Light that moves: `luxel relight` and its player.
#include "luxel/solve/matrix/relighter.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings/python/arrays.h"
#include "bindings/python/options.h"
#include "luxel/arguments/table_options.h"
#include "luxel/base/file.h"
#include "luxel/pipeline/command/relight_options.h"
#include "luxel/pipeline/settings/import_options.h"
#include "luxel/scene/validate.h"
#include "luxel/solve/matrix/lxr.h"

namespace luxel::python {
namespace {

using matrix::Relighter;

struct Settings {
  pipeline::RelightSettings relight;
  bool has_outside_light = false;
};

Settings settings_of(const py::kwargs& options) {
  const auto making = pipeline::relight_options();
  const auto reading = pipeline::import_options();
  const auto outside = pipeline::outside_light_options();
  CLI::App command;
  command.set_help_flag();
  arguments::Given of_making, of_reading, of_outside;
  arguments::add_options(command, making, {}, of_making);
  arguments::add_options(command, reading, {}, of_reading);
  arguments::add_options(command, outside, {}, of_outside);
  int threads = 0;
  command.add_option("--threads", threads)->check(CLI::Range(0, 1024));
  parse(command, options, "luxel.Relighter");
  Settings out;
  const auto read = [&]() -> Status {
    LUXEL_TRY_STATUS(arguments::read_given(of_making, making, out.relight));
    LUXEL_TRY_STATUS(arguments::read_given(of_reading, reading, out.relight.reading));
    return arguments::read_given(of_outside, outside, out.relight.outside);
  };
  if (const Status done = read(); !done) raise(done.error());
  out.relight.threads = threads;
  out.has_outside_light = !of_outside.empty();
  return out;
}

/// Reads the scene if there is none yet, and prepares it. `warnings` gets what is to be told.
Result<Relighter> prepare(std::optional<scene::Scene> scene, const Settings& settings,
                          std::vector<std::string>& warnings, Progress& progress) {
  const pipeline::RelightSettings& s = settings.relight;
  if (scene) {
    LUXEL_TRY(warnings, scene::validate(*scene, "the scene"));
  } else {
    progress.begin("import", 0);
    LUXEL_TRY(import::Imported imported,
              import::import_scene(s.scene, s.reading, s.max_memory_bytes));
    scene = std::move(imported.scene), warnings = std::move(imported.warnings);
  }
  if (settings.has_outside_light) {
    LUXEL_TRY(const std::vector<std::string> more, pipeline::add_outside_light(s.outside, *scene));
    warnings.insert(warnings.end(), more.begin(), more.end());
  }
  LUXEL_TRY(pipeline::Relightable made, pipeline::make_relightable(std::move(*scene), s, progress));
  warnings.insert(warnings.end(), made.warnings.begin(), made.warnings.end());
  return Relighter::make(std::move(made.data), {.direct_at_points = true});
}

Result<Relighter> open(const std::filesystem::path& path) {
  LUXEL_TRY(matrix::RelightData data, matrix::read_lxr(path));
  return Relighter::make(std::move(data), {.direct_at_points = true});
}

Relighter make(const py::object& scene, const py::object& callback, const py::kwargs& options) {
  std::optional<scene::Scene> copy;
  std::filesystem::path file;
  if (py::isinstance<scene::Scene>(scene))
    copy = scene.cast<const scene::Scene&>();
  else
    file = scene.cast<std::filesystem::path>();
  Progress progress;
  if (file.extension() == ".lxr") {
    if (!options.empty()) throw py::type_error("options are for scenes; an .lxr file has its own");
    return value_of(run(progress, callback, [&](Progress&) { return open(file); }));
  }
  Settings settings = settings_of(options);
  settings.relight.scene = copy ? "the scene" : file;
  std::vector<std::string> warnings;
  Relighter out = value_of(run(progress, callback, [&](Progress& p) {
    return prepare(std::move(copy), settings, warnings, p);
  }));
  warn(warnings);
  return out;
}

void check_lights(const std::vector<scene::PunctualLight>& lights) {
  for (const scene::PunctualLight& light : lights)
    if (light.profile != scene::kNone)
      throw py::value_error("light '" + light.name +
                            "' has a distribution (IES), which a "
                            "Relighter does not know");
}

/// Fields of luxel.Relit, in their order.
py::tuple update(Relighter& self, const scene::Scene& lights, const py::object& emission) {
  check_lights(lights.lights);
  const auto radiance = rows_or_none<Vec3, float>(emission, "emission");
  const size_t materials = self.data().material_name.size();
  if (!radiance.empty() && radiance.size() != materials)
    throw py::value_error("emission must have a row for each of " + std::to_string(materials) +
                          " materials");
  const matrix::Relit* relit = nullptr;
  {
    const py::gil_scoped_release without_lock;
    self.update({.punctual = lights.lights, .emission = radiance, .background = lights.background});
    relit = &self.latest();
  }
  return py::make_tuple(array_of_vectors(relit->direct), array_of_vectors(relit->indirect),
                        array_of_vectors(relit->direct_at_points),
                        array_of_vectors(relit->indirect_at_points));
}

void save_lxr(const Relighter& self, const std::filesystem::path& path) {
  Status done;
  {
    const py::gil_scoped_release without_lock;
    done = write_file_atomically(path, matrix::encode_lxr(self.data()));
  }
  if (!done) raise(done.error());
}

const matrix::RelightData& data_of(const py::object& self) {
  return self.cast<const Relighter&>().data();
}

py::array_t<float> vectors(const py::object& self, std::vector<Vec3> matrix::RelightData::*member) {
  const std::vector<Vec3>& values = data_of(self).*member;
  return view_of_vectors(values.data(), values.size(), self);
}

py::list options_of_relighter() {
  std::vector<Described> out;
  describe_all(pipeline::relight_options(), {}, {}, out);
  describe_all(pipeline::import_options(), {}, {}, out);
  describe_all(pipeline::outside_light_options(), {}, {}, out);
  return list_of(out);
}

void add_patches(py::class_<Relighter>& type) {
  using Data = matrix::RelightData;
  type.def_property_readonly(
          "materials", [](const Relighter& self) { return self.data().material_name; },
          "Names of the materials, one for each row of update()'s emission.")
      .def_property_readonly(
          "positions", [](const py::object& self) { return vectors(self, &Data::position); },
          "The middle of each patch [m], (n, 3).")
      .def_property_readonly(
          "normals", [](const py::object& self) { return vectors(self, &Data::normal); },
          "The normal of each patch, (n, 3).")
      .def_property_readonly(
          "areas",
          [](const py::object& self) {
            const std::vector<float>& areas = data_of(self).area_m2;
            return view(areas.data(), {py::ssize_t(areas.size())}, self);
          },
          "The area of each patch [m^2], (n,).")
      .def_property_readonly(
          "reflectance", [](const py::object& self) { return vectors(self, &Data::reflectance); },
          "The reflectance of each patch, (n, 3).")
      .def_property_readonly(
          "material",
          [](const py::object& self) {
            const std::vector<uint32_t>& material = data_of(self).material;
            return view(material.data(), {py::ssize_t(material.size())}, self);
          },
          "The number of each patch's material, (n,).");
}

}  // namespace

void add_relighter(py::module_& module) {
  py::class_<Relighter> type(module, "Relighter",
                             "A scene prepared once, whose light then moves with all its bounces. "
                             "It is divided into patches.");
  type.def(py::init(&make), py::arg("scene"), py::kw_only(), py::arg("progress") = py::none(),
           "Prepares a Scene or the scene of a file, or opens an .lxr file. Options are those of "
           "`luxel relight`.")
      .def("_update", &update)
      .def("save", &save_lxr, py::arg("path"), "Writes an .lxr file.")
      .def_property_readonly(
          "places",
          [](const py::object& self) {
            const std::vector<Vec3>& places = data_of(self).target.position;
            return view_of_vectors(places.data(), places.size(), self);
          },
          "Where light is asked for besides [m], (m, 3): texels of a map, or vertices.")
      .def_property_readonly(
          "texels",
          [](const py::object& self) {
            const auto& texels = data_of(self).target.texel;
            return view(reinterpret_cast<const uint16_t*>(texels.data()),
                        {py::ssize_t(texels.size()), 2}, self);
          },
          "x and y of each place in the map, (m, 2); (0, 2) where places are vertices.")
      .def_property_readonly(
          "codec_error", [](const Relighter& self) { return self.data().codec_error; },
          "What 95 of 100 lights lose less than by the compressed matrix, relative.");
  add_patches(type);
  module.def("_options_of_relighter", &options_of_relighter);
}

}  // namespace luxel::python
