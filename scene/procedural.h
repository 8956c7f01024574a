// Scenes made by code: the ones whose answer is known, and the demo.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace luxel::scene {

/// Which RGB triples stand for the Cornell box's measured spectra; docs/cornell-box.md has the
/// numbers. d65 = the spectra under D65 with a neutral lamp of the luminance of set pbrt's; mitsuba
/// and pbrt = those renderers' scenes.
enum class CornellColors { d65, mitsuba, pbrt };

/// The measured Cornell box in metres (1 unit of the data = 1 mm), Y up, with the published camera.
/// The lamp hangs at y = 548.8 mm, where the ceiling has a hole of its size; `with_blocks` false
/// gives the empty box.
Scene cornell_box(CornellColors colors = CornellColors::pbrt, bool with_blocks = true);

/// A closed box of side 1 m seen from inside: every wall emits radiance `emission` and reflects
/// `reflectance`. Its radiosity is e / (1 - rho) everywhere (e = pi * emission).
/// `tessellation` n gives n x n quads per wall.
Scene furnace_box(Rgb reflectance, Rgb emission, int tessellation = 1);

/// Spheres and cube: a red and a yellow sphere and a gray cube float in a box with green and gray
/// walls, lit by a lamp in its ceiling and, through its open front (+z), by a slightly green
/// background; 478 triangles. [Moreno05, section 5.2, figure 5.8]
Scene spheres_and_cube();

/// A sphere of radius `radius_m` seen from inside (normals point inwards), latitude-longitude-free:
/// an icosahedron subdivided `levels` times; flat shading. One material.
Scene inward_sphere(float radius_m, int levels, Rgb reflectance, Rgb emission);

/// A scene under the name of its file in scenes/.
struct NamedScene {
  std::string file;
  Scene scene;
};
/// All scenes that scenes/ holds.
std::vector<NamedScene> procedural_scenes();

}  // namespace luxel::scene
