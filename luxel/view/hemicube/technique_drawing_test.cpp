// Techniques by shaders against the pictures of `luxel render`, and the faces of a hemicube against
// cameras that look through them. Skipped without a device.
#include "luxel/view/draw/technique_drawing.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "luxel/display/normals_view.h"
#include "luxel/image/flip.h"
#include "luxel/pipeline/render/techniques.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/draw/device_test_support.h"
#include "luxel/view/hemicube/faces_picture.h"
#include "luxel/view/hemicube/mesh_test_support.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view {
namespace {

class TechniqueTest : public testing::OnDevice {
 protected:
  void put(const scene::Scene& scene) {
    auto device = colours_shown(*commands_, scene);
    auto techniques = put_techniques(*device_, scene);
    ASSERT_TRUE(device && techniques);
    scene_ = std::move(*device);
    additions_.techniques = std::move(*techniques);
  }
  void put_normals(const scene::Scene& scene, const scene::Camera& camera) {
    Shapes shapes;
    add_lines(display::lines_of_normals(scene, camera), 1, shapes);
    auto lines = put_shapes(*device_, shapes);
    ASSERT_TRUE(lines);
    additions_.shapes.push_back(std::move(*lines));
  }
  image::Image8 picture_of(const Frame& frame, int width, int height) {
    const auto painter =
        make_painter(*device_, *shaders_, scene_, uint32_t(width), uint32_t(height));
    EXPECT_TRUE(painter);
    auto out = painted(*commands_, {*shaders_, *painter, scene_, nullptr, &additions_}, frame);
    EXPECT_TRUE(out);
    return std::move(*out);
  }

  DeviceScene scene_;
  Additions additions_;
};

double flip_of(const image::Image8& a, const image::Image8& b) {
  const auto linear = [](const image::Image8& from) {
    image::Image out(from.width, from.height, 3);
    for (size_t i = 0; i < out.data.size(); ++i)
      out.data[i] = float(from.data[i / 3 * size_t(from.channels) + i % 3]) / 255;
    return out;
  };
  const image::Image map = image::flip(linear(a), linear(b));
  return std::accumulate(map.data.begin(), map.data.end(), 0.0) / double(map.data.size());
}

/// Balls and a cube of shining paint, which the plates of the paper show.
scene::Scene shining_scene() {
  scene::Scene out = scene::spheres_and_cube();
  for (scene::Material& m : out.materials) m.specular = {0.6f, 0.6f, 0.6f}, m.sharpness = 12;
  return out;
}

TEST_F(TechniqueTest, DrawsWhatRenderDraws) {
  const scene::Scene scene = shining_scene();
  const auto tracer = trace::RayTracer::build(scene);
  const scene::Camera camera = scene.cameras.at(0);
  put(scene);
  pipeline::RenderSettings settings;
  settings.width = 160, settings.height = 120;
  hemicube::HemicubeParams& solver = settings.hemicube.emplace();
  solver.resolution = 16, solver.max_elements = 1500, solver.max_error = 0;
  Progress progress;
  const auto solution =
      hemicube::solve(scene, light::collect_lights(scene), *tracer, solver, progress);
  ASSERT_TRUE(solution);
  const hemicube::Field& field = solution->field;
  ASSERT_TRUE(put_mesh(*device_, corners_of(scene, field.mesh, field.receivers),
                       field.receivers.elements.reflectance, *additions_.techniques));
  put_irradiance(field.irradiance, *additions_.techniques);
  image::Image8 before;
  for (size_t i = 0; i < kTechniques.size(); ++i) {
    const auto* technique = pipeline::find_technique(kTechniques[i].name);
    if (Technique(i) == Technique::elements) continue;
    if (Technique(i) == Technique::radiosity_vertex)
      technique = pipeline::find_technique("radiosity");
    ASSERT_TRUE(technique) << kTechniques[i].name;
    pipeline::Rendered out;
    const auto wanted = technique->draw({scene, *tracer, camera}, settings, out, progress);
    ASSERT_TRUE(wanted);
    Frame frame;
    frame.camera = camera, frame.technique = Technique(i);
    frame.exposure = technique->is_light ? display::readable_exposure(*wanted) : 1;
    const auto curve = technique->is_light ? frame.curve : display::ToneMap::clamp;
    additions_.shapes.clear();
    if (Technique(i) == Technique::normals) put_normals(scene, camera);
    const image::Image8 seen = picture_of(frame, settings.width, settings.height);
    const double apart = flip_of(seen, display::tone_map(*wanted, frame.exposure, curve));
    EXPECT_LT(apart, 0.05) << kTechniques[i].name;
    // No technique passes for another, but that materials here have no textures, without which
    // the two kinds of radiosity are one.
    if (!before.data.empty() && Technique(i) != Technique::radiosity) {
      EXPECT_GT(flip_of(seen, before), 0.01) << kTechniques[i].name;
    }
    before = seen;
  }
}

/// A camera at an element that looks through a whole face of a cube around it.
scene::Camera camera_through(Vec3 from, Vec3 towards, Vec3 up) {
  scene::Camera out;
  const Vec3 right = cross(towards, up);
  for (size_t r = 0; r < 3; ++r) {
    out.world_from_camera.row[r] = {right[int(r)], up[int(r)], -towards[int(r)], from[int(r)]};
  }
  out.fov_y_rad = kPi / 2, out.aspect = 1;
  return out;
}

// The item buffer by rays, and the surfaces in their triangles' colours by the device, as the paper
// draws a hemicube: five pictures from a vertex.
TEST_F(TechniqueTest, TheDeviceSeesThroughTheFacesOfAHemicubeWhatRaysSee) {
  constexpr int kSize = 64;
  const auto mesh = testing::mesh_in(scene::cornell_box(), 0.15f);
  const scene::Scene& scene = mesh->in->scene;
  put(scene);
  ASSERT_TRUE(put_mesh(*device_, corners_of(scene, mesh->mesh, mesh->receivers),
                       mesh->receivers.elements.reflectance, *additions_.techniques));
  uint32_t element = 0;  // on the floor, not at its rim
  const auto away = [&](uint32_t e) {
    return length(mesh->receivers.elements.position[e] - Vec3{0.15f, 0, 0.4f});
  };
  for (uint32_t e = 0; e < mesh->receivers.size(); ++e)
    if (away(e) < away(element)) element = e;
  Progress progress;
  const auto report =
      report_on(*mesh, std::vector<Rgb>(mesh->receivers.size()), element, kSize, progress);
  ASSERT_TRUE(report);
  const image::Image8 cross_shown = faces_picture(*mesh, *report, {});
  const Vec3 normal = mesh->receivers.elements.normal[element];
  const luxel::Frame cube = hemicube::frame_of_cube(normal);
  const Vec3 x = cube.tangent, y = cube.bitangent;
  const std::array<std::pair<Vec3, Vec3>, 5> faces{
      {{normal, y}, {x, normal}, {-x, normal}, {y, normal}, {-y, normal}}};
  size_t first = 0, same = 0, all = 0;
  for (size_t face = 0; face < 5; ++face) {
    Frame frame;
    frame.technique = Technique::elements;
    frame.camera =
        camera_through(report->position + normal * 1e-4f, faces[face].first, faces[face].second);
    const image::Image8 seen = picture_of(frame, kSize, kSize);
    const int rows = face == 0 ? kSize : kSize / 2;
    for (int i = 0; i < rows * kSize; ++i, ++first) {
      const hemicube::Item& item = report->items.items[first];
      if (item.kind != hemicube::SeenKind::surface) continue;
      const CrossPlace at = place_in_cross(kSize, first);
      const uint8_t* wanted = cross_shown.data.data() + 4 * size_t(at.y * 2 * kSize + at.x);
      int apart = 0;
      for (size_t c = 0; c < 3; ++c)
        apart = std::max(apart, std::abs(int(wanted[c]) - int(seen.data[3 * size_t(i) + c])));
      same += apart <= 3, ++all;
    }
  }
  // Pixels at the edges of triangles are means of two colours.
  EXPECT_GT(all, size_t(kSize * kSize));
  EXPECT_GT(double(same), 0.75 * double(all));
}

}  // namespace
}  // namespace luxel::view
