// Scenes: built of arrays, or read from files.
#include "luxel/scene/scene.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings/python/arrays.h"
#include "bindings/python/options.h"
#include "luxel/arguments/table_options.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/settings/import_options.h"
#include "luxel/scene/shapes.h"

namespace luxel::python {
namespace {

/// Raises ValueError for a matrix that is not finite, or makes things flat.
Mat34 transform_of(const py::object& object) {
  if (object.is_none()) return {};
  const auto array = object.cast<Array<float>>();
  if (array.ndim() != 2 || array.shape(1) != 4 || (array.shape(0) != 3 && array.shape(0) != 4))
    throw py::value_error("transform must have the shape (3, 4) or (4, 4)");
  const auto at = array.unchecked<2>();
  Mat34 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) out.row[i][j] = at(i, j);
  const float volume = std::abs(determinant(out));
  if (!std::isfinite(volume) || volume == 0 || !is_finite(column(out, 3)))
    throw py::value_error("transform must be finite, and must not make things flat");
  return out;
}

uint32_t add_material(scene::Scene& scene, const std::string& name, const Array<float>& color,
                      const Array<float>& emission, bool double_sided) {
  const uint32_t number =
      scene::add_material(scene, name, color_of(color, "color"), color_of(emission, "emission"));
  scene.materials[number].double_sided = double_sided;
  return number;
}

/// Numbers of the materials of triangles, from one number or one for each.
std::vector<uint32_t> materials_of(const py::object& material, size_t triangles, size_t materials) {
  const Array<int64_t> given = whole_numbers_of(material, "material");
  if (given.ndim() > 1 || (given.ndim() == 1 && size_t(given.size()) != triangles))
    throw py::value_error("material must be a number, or one for each triangle");
  for (py::ssize_t i = 0; i < given.size(); ++i)
    if (given.data()[i] < 0 || uint64_t(given.data()[i]) >= materials)
      throw py::value_error("there is no material " + std::to_string(given.data()[i]) +
                            "; add_material() makes one");
  if (given.ndim() == 0) return std::vector<uint32_t>(triangles, uint32_t(*given.data()));
  return {given.data(), given.data() + given.size()};
}

void check_rows(size_t rows, size_t positions, const char* name) {
  if (rows != 0 && rows != positions)
    throw py::value_error(std::string(name) + " must have a row for each position");
}

void add_mesh(scene::Scene& scene, const Array<float>& positions, const py::object& triangles,
              const py::object& material, const std::string& name, const py::object& normals,
              const py::object& uv, const py::object& lightmap_uv, const py::object& transform) {
  scene::Mesh mesh;
  mesh.name = name;
  mesh.positions = rows_of<Vec3>(positions, "positions");
  mesh.normals = rows_or_none<Vec3, float>(normals, "normals");
  mesh.uv0 = rows_or_none<Vec2, float>(uv, "uv");
  mesh.uv1 = rows_or_none<Vec2, float>(lightmap_uv, "lightmap_uv");
  check_rows(mesh.normals.size(), mesh.positions.size(), "normals");
  check_rows(mesh.uv0.size(), mesh.positions.size(), "uv");
  check_rows(mesh.uv1.size(), mesh.positions.size(), "lightmap_uv");
  for (const auto& corners :
       rows_of<std::array<int64_t, 3>>(whole_numbers_of(triangles, "triangles"), "triangles")) {
    for (const int64_t corner : corners)
      if (corner < 0 || uint64_t(corner) >= mesh.positions.size())
        throw py::value_error("triangles name row " + std::to_string(corner) + " of " +
                              std::to_string(mesh.positions.size()) + " positions");
    mesh.triangles.push_back({uint32_t(corners[0]), uint32_t(corners[1]), uint32_t(corners[2])});
  }
  mesh.triangle_material = materials_of(material, mesh.triangles.size(), scene.materials.size());
  scene::place(scene, std::move(mesh), transform_of(transform));
}

void add_point_light(scene::Scene& scene, const Array<float>& position,
                     const Array<float>& intensity, const std::string& name) {
  scene::PunctualLight light;
  light.name = name;
  light.position = vec3_of(position, "position");
  light.intensity = color_of(intensity, "intensity");
  scene.lights.push_back(light);
}

Vec3 direction_of(const Array<float>& array) {
  const Vec3 out = vec3_of(array, "direction");
  if (out == Vec3{}) throw py::value_error("direction must not be (0, 0, 0)");
  return normalize(out);
}

void add_spot_light(scene::Scene& scene, const Array<float>& position,
                    const Array<float>& direction, const Array<float>& intensity, float cone_deg,
                    float inner_cone_deg, const std::string& name) {
  if (!(cone_deg > 0 && cone_deg <= 90 && inner_cone_deg >= 0 && inner_cone_deg < cone_deg))
    throw py::value_error("cones are half angles: 0 <= inner_cone_deg < cone_deg <= 90");
  add_point_light(scene, position, intensity, name);
  scene::PunctualLight& light = scene.lights.back();
  light.kind = scene::PunctualLight::Kind::spot;
  light.outer_cone_rad = cone_deg * kPi / 180, light.inner_cone_rad = inner_cone_deg * kPi / 180;
  light.direction = direction_of(direction);
}

void add_sun(scene::Scene& scene, const Array<float>& direction, const Array<float>& irradiance,
             float angular_radius_deg, const std::string& name) {
  if (!(angular_radius_deg >= 0 && angular_radius_deg < 90))
    throw py::value_error("angular_radius_deg must be from 0 to below 90");
  scene::PunctualLight light;
  light.name = name, light.kind = scene::PunctualLight::Kind::directional;
  light.direction = direction_of(direction);
  light.intensity = color_of(irradiance, "irradiance");
  light.angular_radius_rad = angular_radius_deg * kPi / 180;
  scene.lights.push_back(light);
}

scene::Scene load(const std::filesystem::path& path, const py::kwargs& options) {
  CLI::App command;
  command.set_help_flag();
  arguments::Given given;
  arguments::add_options(command, pipeline::import_options(), {}, given);
  parse(command, options, "luxel.load");
  import::ImportParams params;
  if (Status read = arguments::read_given(given, pipeline::import_options(), params); !read)
    raise(read.error());
  std::optional<Result<import::Imported>> imported;
  {
    const py::gil_scoped_release without_lock;
    imported.emplace(import::import_scene(path, params));
  }
  import::Imported found = value_of(std::move(*imported));
  warn(found.warnings);
  return std::move(found.scene);
}

size_t triangle_count(const scene::Scene& scene) { return scene::first_triangles(scene).back(); }

/// The corners of all drawn triangles in the world: (n, 3, 3).
py::array_t<float> world_triangles(const scene::Scene& scene) {
  py::array_t<float> out({py::ssize_t(triangle_count(scene)), py::ssize_t(3), py::ssize_t(3)});
  float* at = out.mutable_data();
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      const scene::Triangle3 corners = scene::world_triangle(scene, i, t);
      for (const Vec3 p : {corners.a, corners.b, corners.c}) *at++ = p.x, *at++ = p.y, *at++ = p.z;
    }
  return out;
}

template <class T>
std::vector<std::string> names_of(const std::vector<T>& things) {
  std::vector<std::string> out;
  for (const T& one : things) out.push_back(one.name);
  return out;
}

std::array<float, 3> background(const scene::Scene& scene) {
  return {scene.background.x, scene.background.y, scene.background.z};
}

std::string summary_of(const scene::Scene& scene) {
  return fmt::format("<luxel.Scene: {} triangles, {} materials, {} lights>", triangle_count(scene),
                     scene.materials.size(), scene.lights.size());
}

}  // namespace

void add_scene(py::module_& module) {
  using scene::Scene;
  py::class_<Scene>(module, "Scene", py::is_final(),
                    "Meshes, materials and lights. Lengths in metres, y is up.")
      .def(py::init<>())
      .def("add_material", &add_material, py::arg("name"), py::arg("color"), py::kw_only(),
           py::arg("emission") = 0.0f, py::arg("double_sided") = false,
           "Adds a diffuse material: reflectance from 0 to 1, radiance that it emits "
           "[W/(sr m^2)]. Returns its number.")
      .def("add_mesh", &add_mesh, py::arg("positions"), py::arg("triangles"), py::arg("material"),
           py::kw_only(), py::arg("name") = "mesh", py::arg("normals") = py::none(),
           py::arg("uv") = py::none(), py::arg("lightmap_uv") = py::none(),
           py::arg("transform") = py::none(),
           "Adds triangles (m, 3) of rows of positions (n, 3), counter-clockwise from the front. "
           "The material is a number, or one for each triangle.")
      .def("add_point_light", &add_point_light, py::arg("position"), py::arg("intensity"),
           py::kw_only(), py::arg("name") = "", "Adds a point light of an intensity [W/sr].")
      .def("add_spot_light", &add_spot_light, py::arg("position"), py::arg("direction"),
           py::arg("intensity"), py::arg("cone_deg"), py::kw_only(), py::arg("inner_cone_deg") = 0,
           py::arg("name") = "",
           "Adds a spot light of an intensity [W/sr]. Its cones are given by half their angles.")
      .def("add_sun", &add_sun, py::arg("direction"), py::arg("irradiance"), py::kw_only(),
           py::arg("angular_radius_deg") = 0, py::arg("name") = "",
           "Adds a directional light, by the direction in which it travels and the irradiance of a "
           "surface that faces it [W/m^2].")
      .def_property(
          "background", &background,
          [](Scene& scene, const Array<float>& color) {
            scene.background = color_of(color, "background");
          },
          "Radiance of the surroundings [W/(sr m^2)].")
      .def_property_readonly(
          "instances", [](const Scene& scene) { return names_of(scene.instances); },
          "Names of the meshes that stand in the world, in the order of their numbers.")
      .def_property_readonly(
          "materials", [](const Scene& scene) { return names_of(scene.materials); },
          "Names of materials, in the order of their numbers.")
      .def_property_readonly(
          "origin",
          [](const Scene& scene) {
            const DVec3 o = scene.origin;
            return py::array_t<double>(3, std::array{o.x, o.y, o.z}.data());
          },
          "The place in the world of the file that (0, 0, 0) here stands for [m]: not 0 for a file "
          "far from its own origin. Add it to coordinates to get those of the file.")
      .def_property_readonly("triangles", &world_triangles,
                             "Corners of all triangles in the world, (n, 3, 3): those of the first "
                             "instance, then those of the next. A copy.")
      .def_property_readonly(
          "first_triangle",
          [](const Scene& scene) {
            const std::vector<uint32_t> first = scene::first_triangles(scene);
            py::array_t<int64_t> out{py::ssize_t(first.size())};
            std::copy(first.begin(), first.end(), out.mutable_data());
            return out;
          },
          "The row of `triangles` at which each instance begins, and one entry more for the end.")
      .def("__repr__", &summary_of);
  module.def("load", &load, py::arg("path"),
             "Reads the scene of a file. Its warnings become Python's.");
  module.def("_options_of_load", [] {
    std::vector<Described> out;
    describe_all(pipeline::import_options(), {}, {}, out);
    return list_of(out);
  });
}

}  // namespace luxel::python
