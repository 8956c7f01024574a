#include <array>
#include <cmath>

#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/validate/agreement.h"

namespace luxel::validate {
namespace {

constexpr Rgb gray(float v) { return {v, v, v}; }

/// A room of 4 x 3 x 4 m seen from inside. `open_front` leaves out the wall at z = 2.
scene::Mesh room_walls(uint32_t floor, uint32_t walls, bool open_front) {
  scene::Mesh mesh;
  mesh.name = "room";
  const float x = 2, y = 3, z = 2;
  scene::add_quad(mesh, {Vec3{-x, 0, -z}, {-x, 0, z}, {x, 0, z}, {x, 0, -z}}, floor);
  scene::add_quad(mesh, {Vec3{-x, y, -z}, {x, y, -z}, {x, y, z}, {-x, y, z}}, walls);
  scene::add_quad(mesh, {Vec3{-x, 0, -z}, {x, 0, -z}, {x, y, -z}, {-x, y, -z}}, walls);
  scene::add_quad(mesh, {Vec3{-x, 0, z}, {-x, 0, -z}, {-x, y, -z}, {-x, y, z}}, walls);
  scene::add_quad(mesh, {Vec3{x, 0, -z}, {x, 0, z}, {x, y, z}, {x, y, -z}}, walls);
  if (!open_front) scene::add_quad(mesh, {Vec3{x, 0, z}, {-x, 0, z}, {-x, y, z}, {x, y, z}}, walls);
  return mesh;
}

scene::Scene point_light_in_a_room() {
  scene::Scene s;
  const uint32_t red = scene::add_material(s, "floor", {0.7f, 0.3f, 0.2f});
  const uint32_t white = scene::add_material(s, "walls", gray(0.8f));
  scene::place(s, room_walls(red, white, false));
  scene::Mesh table;
  table.name = "table";
  scene::add_box(table, {-0.6f, 0.7f, -0.4f}, {0.6f, 0.8f, 0.4f}, white);
  scene::place(s, std::move(table));
  scene::PunctualLight lamp;
  lamp.position = {0.4f, 2.2f, 0.3f};
  lamp.intensity = {10, 9, 7};
  s.lights.push_back(lamp);
  return s;
}

/// A checkerboard of n x n squares, and the same as holes of a mask.
scene::Texture checkerboard(int n, bool holes) {
  scene::Texture t;
  t.name = "checkerboard";
  t.width = t.height = n;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const bool even = (i + j) % 2 == 0;
      const uint8_t c = holes || even ? 230 : 60;
      const uint8_t alpha = holes && !even ? 0 : 255;
      t.rgba.insert(t.rgba.end(), {c, c, c, alpha});
    }
  return t;
}

void add_uv_from_xz(scene::Mesh& mesh, float scale) {
  for (const Vec3& p : mesh.positions) mesh.uv0.push_back({p.x * scale + 0.5f, p.z * scale + 0.5f});
}

/// Point, spot and sun, a textured lamp, a textured floor and a grille with holes.
scene::Scene every_kind_of_light() {
  scene::Scene s;
  s.textures = {checkerboard(4, false), checkerboard(8, true)};
  const uint32_t tiles = scene::add_material(s, "tiles", {0.9f, 0.8f, 0.7f});
  const uint32_t walls = scene::add_material(s, "walls", gray(0.7f));
  const uint32_t grille = scene::add_material(s, "grille", gray(0.4f));
  const uint32_t panel = scene::add_material(s, "panel", gray(0.2f), {6, 5, 3});
  s.materials[tiles].base_color_texture = {.texture = 0, .filter = scene::Filter::nearest};
  s.materials[grille].base_color_texture = {.texture = 1, .filter = scene::Filter::nearest};
  s.materials[grille].alpha_mode = scene::AlphaMode::mask;
  s.materials[panel].emission_texture = {.texture = 0, .filter = scene::Filter::nearest};
  scene::Mesh room = room_walls(tiles, walls, true);
  add_uv_from_xz(room, 0.25f);
  scene::place(s, std::move(room));
  scene::Mesh plate;
  plate.name = "grille";
  // Seen from above and from below: two one-sided plates, so that no surface has two lights.
  scene::add_quad(plate, {Vec3{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}}, grille);
  scene::add_quad(plate, {Vec3{-1, 0.98f, -1}, {1, 0.98f, -1}, {1, 0.98f, 1}, {-1, 0.98f, 1}},
                  grille);
  add_uv_from_xz(plate, 0.5f);
  scene::place(s, std::move(plate));
  scene::Mesh light;
  light.name = "panel";
  scene::add_quad(
      light,
      {Vec3{-0.5f, 2.9f, -1.5f}, {0.5f, 2.9f, -1.5f}, {0.5f, 2.9f, -0.5f}, {-0.5f, 2.9f, -0.5f}},
      panel);
  add_uv_from_xz(light, 1);
  scene::place(s, std::move(light));
  scene::PunctualLight point, spot, sun;
  point.position = {-1.2f, 1.8f, 1};
  point.intensity = {3, 2, 1};
  spot.kind = scene::PunctualLight::Kind::spot;
  spot.position = {1.2f, 2.7f, 0.8f};
  spot.direction = normalize(Vec3{-0.3f, -1, -0.5f});
  spot.inner_cone_rad = 0.2f, spot.outer_cone_rad = 0.6f;
  spot.intensity = {4, 6, 10};
  sun.kind = scene::PunctualLight::Kind::directional;
  // No simple numbers: edges of shadows must not run through texels' samples.
  sun.direction = normalize(Vec3{0.31f, -0.623f, -1});
  sun.intensity = gray(5);
  s.lights = {point, spot, sun};
  return s;
}

/// The wall at z = 2 has an opening of 1.6 x 1.2 m, through which a blue sky and a broad sun shine.
scene::Scene window() {
  scene::Scene s;
  const uint32_t floor = scene::add_material(s, "floor", {0.5f, 0.35f, 0.2f});
  const uint32_t walls = scene::add_material(s, "walls", gray(0.75f));
  scene::Mesh room = room_walls(floor, walls, true);
  scene::add_quad_with_hole(room, {Vec3{2, 0, 2}, {-2, 0, 2}, {-2, 3, 2}, {2, 3, 2}},
                            {Vec3{0.8f, 1, 2}, {-0.8f, 1, 2}, {-0.8f, 2.2f, 2}, {0.8f, 2.2f, 2}},
                            walls);
  scene::place(s, std::move(room));
  s.background = {0.5f, 0.7f, 1};
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{0.4f, -0.7f, -1});
  sun.angular_radius_rad = 0.03f;
  sun.intensity = {20, 18, 14};
  s.lights.push_back(sun);
  return s;
}

uint32_t add_glass(scene::Scene& s, std::string name, Rgb color) {
  const uint32_t glass = scene::add_material(s, std::move(name), color);
  s.materials[glass].transmission = 0.8f;
  s.materials[glass].double_sided = true;
  return glass;
}

/// window() with panes of amber and blue in its opening, and no light but that of the sun.
scene::Scene sun_through_glass() {
  scene::Scene s = window();
  s.background = {};
  const uint32_t amber = add_glass(s, "amber", {0.9f, 0.6f, 0.2f});
  const uint32_t blue = add_glass(s, "blue", {0.3f, 0.5f, 0.9f});
  scene::Mesh panes;
  panes.name = "panes";
  const float y0 = 1, y1 = 2.2f, z = 2;
  scene::add_quad(panes, {Vec3{0, y0, z}, {-0.8f, y0, z}, {-0.8f, y1, z}, {0, y1, z}}, amber);
  scene::add_quad(panes, {Vec3{0.8f, y0, z}, {0, y0, z}, {0, y1, z}, {0.8f, y1, z}}, blue);
  scene::place(s, std::move(panes));
  return s;
}

/// sun_through_glass() under window()'s sky, with a screen of green glass across the room: what is
/// behind it has most of its light from surfaces and sky, through glass.
scene::Scene coloured_glass() {
  scene::Scene s = sun_through_glass();
  s.background = window().background;
  const uint32_t green = add_glass(s, "green", {0.4f, 0.9f, 0.5f});
  scene::Mesh screen;
  screen.name = "screen";
  const float x = 1.6f, y0 = 0.2f, y1 = 2.7f, z = -0.3f;
  scene::add_quad(screen, {Vec3{-x, y0, z}, {x, y0, z}, {x, y1, z}, {-x, y1, z}}, green);
  scene::place(s, std::move(screen));
  return s;
}

/// A map of the sky: bright above, dim below, and a sun of two pixels that is 20,000 times as
/// bright, where window() has its own.
scene::Environment sky_map() {
  scene::Environment map{128, 64, {}, 0.3f};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      map.radiance.push_back(Rgb{0.5f, 0.7f, 1} * (y < 32 ? 1.5f - float(y) / 40 : 0.25f));
  const size_t sun = scene::pixel_towards(map, normalize(Vec3{-0.4f, 0.7f, 1}));
  map.radiance[sun] = map.radiance[sun + 1] = {9000, 8000, 6000};
  return map;
}

/// window() under a map of the sky.
scene::Scene window_to_a_sky_map() {
  scene::Scene s = window();
  s.lights.clear(), s.background = {};
  s.lights.clear();
  {
    scene::Mesh lamp;
    lamp.name = "lamp";
    const uint32_t e = scene::add_material(s, "e", gray(0.2f), {6, 5, 3});
    scene::add_quad(lamp, {Vec3{-1, 1.5f, 3}, {-1, 3, 3}, {1, 3, 3}, {1, 1.5f, 3}}, e);
    scene::place(s, std::move(lamp));
  }
  s.environment = sky_map();
  return s;
}

}  // namespace

std::vector<AgreementScene> agreement_scenes() {
  return {{"Cornell box", scene::cornell_box(), 96, "an area light, colour bleeding"},
          {"point light in a room", point_light_in_a_room(), 96, "a point light, a closed room"},
          {"spheres and cube", scene::spheres_and_cube(), 128, "smooth surfaces, a background"},
          {"every kind of light", every_kind_of_light(), 128,
           "point, spot and sun, an emissive texture, a textured floor, a mask with holes"},
          {"window", window(), 96, "sky and a broad sun through an opening"},
          {"sky map", window_to_a_sky_map(), 96, "the same under an environment with a sun"},
          {"sun through glass", sun_through_glass(), 96, "the sun through panes of two colours"},
          {"coloured glass", coloured_glass(), 96,
           "sky and indirect light through panes and a screen of coloured glass"}};
}

}  // namespace luxel::validate
