// The measured Cornell box; where each number comes from stands in docs/bench/cornell-box.md.
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

struct Palette {
  Rgb white, green, red, lamp;  ///< lamp: radiance
};

Palette palette_of(CornellColors colors) {
  switch (colors) {
    case CornellColors::d65:
      // The spectra reduced under D65 see a white lamp; the data names no radiance for it. It gets
      // the luminance of set P's, so that pictures of both sets are equally bright:
      // 0.2126 * 17 + 0.7152 * 12 + 0.0722 * 4 = 12.4854.
      return {{0.738f, 0.736f, 0.738f},
              {0.069f, 0.398f, 0.087f},
              {0.494f, 0.049f, 0.051f},
              {12.4854f, 12.4854f, 12.4854f}};
    case CornellColors::mitsuba:
      return {{0.885809f, 0.698859f, 0.666422f},
              {0.105421f, 0.37798f, 0.076425f},
              {0.570068f, 0.0430135f, 0.0443706f},
              {18.387f, 13.9873f, 6.75357f}};
    case CornellColors::pbrt:
      break;
  }
  return {{0.725f, 0.71f, 0.68f}, {0.14f, 0.45f, 0.091f}, {0.63f, 0.065f, 0.05f}, {17, 12, 4}};
}

Vec3 metres(double x_mm, double y_mm, double z_mm) {
  return {float(x_mm * 1e-3), float(y_mm * 1e-3), float(z_mm * 1e-3)};
}

/// Counter-clockwise from above, as the data lists the tops of the blocks; the sides go down from
/// there to the floor. The bottom, which stands on the floor, is left out as in the data.
Mesh block(const char* name, const Quad& top, uint32_t material) {
  Mesh mesh;
  mesh.name = name;
  add_quad(mesh, top, material);
  const auto on_floor = [](Vec3 p) { return Vec3{p.x, 0, p.z}; };
  for (size_t i = 0; i < 4; ++i) {
    const Vec3 a = top[i], b = top[(i + 1) % 4];
    add_quad(mesh, {a, on_floor(a), on_floor(b), b}, material);
  }
  return mesh;
}

Mesh wall(const char* name, const Quad& quad, uint32_t material) {
  Mesh mesh;
  mesh.name = name;
  add_quad(mesh, quad, material);
  return mesh;
}

/// Position (278, 273, -800) mm, looking along +z, focal length 35 mm on a film of 25 x 25 mm.
Camera published_camera() {
  Camera camera;
  camera.name = "published";
  camera.world_from_camera = look_at(metres(278, 273, -800), metres(278, 273, 0), {0, 1, 0});
  camera.fov_y_rad = float(2 * std::atan(0.0125 / 0.035));
  camera.aspect = 1;
  return camera;
}

}  // namespace

Scene cornell_box(CornellColors colors, bool with_blocks) {
  const Palette palette = palette_of(colors);
  Scene scene;
  scene.name = "cornell-box";
  const uint32_t white = add_material(scene, "white", palette.white);
  const uint32_t red = add_material(scene, "red", palette.red);
  const uint32_t green = add_material(scene, "green", palette.green);
  const uint32_t light = add_material(scene, "light", {0.78f, 0.78f, 0.78f}, palette.lamp);

  // The lamp lies in the plane of the ceiling: without a hole there a ray could meet either.
  const Quad lamp{metres(343, 548.8, 227), metres(343, 548.8, 332), metres(213, 548.8, 332),
                  metres(213, 548.8, 227)};
  const Quad ceiling{metres(556, 548.8, 0), metres(556, 548.8, 559.2), metres(0, 548.8, 559.2),
                     metres(0, 548.8, 0)};
  place(scene,
        wall("floor",
             {metres(552.8, 0, 0), metres(0, 0, 0), metres(0, 0, 559.2), metres(549.6, 0, 559.2)},
             white));
  place(scene, wall("light", lamp, light));
  Mesh ceiling_mesh;
  ceiling_mesh.name = "ceiling";
  add_quad_with_hole(ceiling_mesh, ceiling, lamp, white);
  place(scene, std::move(ceiling_mesh));
  place(scene, wall("back wall",
                    {metres(549.6, 0, 559.2), metres(0, 0, 559.2), metres(0, 548.8, 559.2),
                     metres(556, 548.8, 559.2)},
                    white));
  place(scene,
        wall("right wall",
             {metres(0, 0, 559.2), metres(0, 0, 0), metres(0, 548.8, 0), metres(0, 548.8, 559.2)},
             green));
  // The measured left wall is not plane: its fourth corner lies 3.2 mm off the other three.
  place(scene, wall("left wall",
                    {metres(552.8, 0, 0), metres(549.6, 0, 559.2), metres(556, 548.8, 559.2),
                     metres(556, 548.8, 0)},
                    red));
  if (with_blocks) {
    place(scene, block("short block",
                       {metres(130, 165, 65), metres(82, 165, 225), metres(240, 165, 272),
                        metres(290, 165, 114)},
                       white));
    place(scene, block("tall block",
                       {metres(423, 330, 247), metres(265, 330, 296), metres(314, 330, 456),
                        metres(472, 330, 406)},
                       white));
  }
  scene.cameras.push_back(published_camera());
  return scene;
}

}  // namespace luxel::scene
