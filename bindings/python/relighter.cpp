// Light that moves: `luxel relight` and its player.
#include "luxel/solve/matrix/relighter.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <mutex>

#include "bindings/python/arrays.h"
#include "bindings/python/options.h"
#include "luxel/arguments/table_options.h"
#include "luxel/base/file.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/command/relight_options.h"
#include "luxel/pipeline/settings/import_options.h"
#include "luxel/scene/brightness.h"
#include "luxel/scene/validate.h"
#include "luxel/solve/matrix/lxr.h"

namespace luxel::python {
namespace {

/// A relighter that one thread uses at a time.
struct SharedRelighter {
  std::optional<matrix::Relighter> relighter;  ///< always there, once it is made
  std::mutex mutex;                            ///< taken without the interpreter's lock
};
using Relighter = matrix::Relighter;

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
  for (const auto& row : making) arguments::exclude_each_other(command, row);
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

std::unique_ptr<SharedRelighter> make(const py::object& scene, const py::object& callback,
                                      const py::kwargs& options) {
  std::optional<scene::Scene> copy;
  std::filesystem::path file;
  if (py::isinstance<scene::Scene>(scene))
    copy = scene.cast<const scene::Scene&>();
  else
    file = path_of(scene);
  Progress progress;
  auto out = std::make_unique<SharedRelighter>();
  if (file.extension() == ".lxr") {
    if (!options.empty()) throw py::type_error("options are for scenes; an .lxr file has its own");
    out->relighter.emplace(
        value_of(run(progress, callback, [&](Progress&) { return open(file); })));
    return out;
  }
  Settings settings = settings_of(options);
  settings.relight.scene = copy ? "the scene" : file;
  if (const Status right = pipeline::check_making(settings.relight); !right) raise(right.error());
  std::vector<std::string> warnings;
  out->relighter.emplace(value_of(run(progress, callback, [&](Progress& p) {
    const ThreadLimit limit(settings.relight.threads);
    return prepare(std::move(copy), settings, warnings, p);
  })));
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

void check_emission(const std::vector<Rgb>& emission, size_t materials) {
  if (emission.size() != materials)
    throw py::value_error("emission must have a row for each of " + std::to_string(materials) +
                          " materials");
  for (size_t i = 0; i < emission.size(); ++i)
    if (min_component(emission[i]) < 0 || max_component(emission[i]) > scene::kBrightest)
      throw py::value_error("emission[" + std::to_string(i) + "] must be from 0 to 1e15");
}

void check_light(const matrix::Relit& relit) {
  for (const auto* light :
       {&relit.direct, &relit.indirect, &relit.direct_at_points, &relit.indirect_at_points})
    for (const Rgb e : *light)
      if (!scene::is_held_light(e))
        throw py::value_error("the light is too bright to store; lower the intensities");
}

/// Fields of luxel.Relit, in their order.
py::tuple update(SharedRelighter& self, const scene::Scene& lights, const py::object& emission) {
  check_lights(lights.lights);
  const auto radiance = rows_or_none<Vec3, float>(emission, "emission");
  if (!emission.is_none()) check_emission(radiance, self.relighter->data().material_name.size());
  // Another thread may change the scene as soon as the interpreter's lock is free.
  const std::vector<scene::PunctualLight> punctual = lights.lights;
  const Rgb background = lights.background;
  matrix::Relit relit;
  {
    const py::gil_scoped_release without_lock;
    const std::lock_guard one_at_a_time(self.mutex);
    self.relighter->update({.punctual = punctual, .emission = radiance, .background = background});
    relit = self.relighter->latest();
  }
  check_light(relit);
  return py::make_tuple(array_of_vectors(relit.direct), array_of_vectors(relit.indirect),
                        array_of_vectors(relit.direct_at_points),
                        array_of_vectors(relit.indirect_at_points));
}

void save_lxr(const SharedRelighter& self, const std::filesystem::path& path) {
  if (path.extension() != ".lxr") throw py::value_error("the name of the file must end in .lxr");
  Status done;
  {
    const py::gil_scoped_release without_lock;
    done = write_file_atomically(path, matrix::encode_lxr(self.relighter->data()));
  }
  if (!done) raise(done.error());
}

const matrix::RelightData& data_of(const py::object& self) {
  return self.cast<const SharedRelighter&>().relighter->data();
}

py::array_t<float> vectors(const py::object& self, std::vector<Vec3> matrix::RelightData::*member) {
  const std::vector<Vec3>& values = data_of(self).*member;
  return view_of_vectors(values.data(), values.size(), self);
}

py::list options_of_relighter() {
  std::vector<Described> out;
  describe_all(pipeline::relight_options(), {}, {}, out);
  describe_all(pipeline::import_options(), {}, {}, out);
  describe_all(pipeline::outside_light_options(), {}, {"--ies"}, out);
  return list_of(out);
}

void add_patches(py::class_<SharedRelighter>& type) {
  using Data = matrix::RelightData;
  type.def_property_readonly(
          "materials",
          [](const SharedRelighter& self) { return self.relighter->data().material_name; },
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
  py::class_<SharedRelighter> type(
      module, "Relighter", py::is_final(),
      "A scene in patches, prepared once, whose light then moves with all its bounces.");
  type.def(py::init(&make), py::arg("scene"), py::kw_only(), py::arg("progress") = py::none(),
           "Prepares a Scene or the scene in a file, with the options of `luxel relight`, or opens "
           "an .lxr file.")
      .def("_update", &update)
      .def("save", &save_lxr, py::arg("path"), "Writes an .lxr file.")
      .def_property_readonly(
          "places",
          [](const py::object& self) {
            const std::vector<Vec3>& places = data_of(self).target.position;
            return view_of_vectors(places.data(), places.size(), self);
          },
          "Places where light is computed [m], (m, 3): texels of a map, or vertices.")
      .def_property_readonly(
          "texels",
          [](const py::object& self) {
            const auto& texels = data_of(self).target.texel;
            return view(reinterpret_cast<const uint16_t*>(texels.data()),
                        {py::ssize_t(texels.size()), 2}, self);
          },
          "x and y of each place in the map, (m, 2); (0, 2) where places are vertices.")
      .def_property_readonly(
          "codec_error",
          [](const SharedRelighter& self) { return self.relighter->data().codec_error; },
          "The relative loss by the compressed matrix that 95 of 100 lights stay below.");
  add_patches(type);
  module.def("_options_of_relighter", &options_of_relighter);
}

}  // namespace luxel::python
