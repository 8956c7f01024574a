// Scenes made by code: the ones whose answer is known, and the demo.
#pragma once

#include <string>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// The RGB triples that stand for the Cornell box's measured spectra; docs/bench/cornell-box.md has
/// the numbers. d65 = the spectra under D65 with a neutral lamp of the luminance of set pbrt's;
/// mitsuba and pbrt = those renderers' scenes.
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

/// The empty box that [Rodriguez06, section 5.8] measures on: a closed cube 2 m wide (1 unit of the
/// paper = 1 cm), one wall red, one green, seen from inside, with a square lamp of radiosity
/// (100.4, 96.8, 90) in the middle of its ceiling. Each wall is a grid of 5 x 5 quads; the ceiling
/// is cut by the lamp's edges into nine grids that share no vertex. Cut further, into n^2 quads per
/// wall, that makes 6 (n + 1)^2 + 4 n + 8 vertices: 774, 2734, 10254 and 15814 for the paper's
/// tessellation factors 20, 10, 5 and 4, which stand for quads 0.2, 0.1, 0.05 and 0.04 m wide.
Scene radiosity_box();

/// The radiosity_box() with a sphere under the lamp and a torus above it, both smooth. The paper
/// gives no sizes; the tessellation is ours, such that the vertices are 3.5 times those of the
/// empty box at factor 20, as the paper's times are: 203 s and 58 s. [Rodriguez06, plate C.10]
Scene radiosity_box_with_shapes();

/// An office: a room of 5 x 4 x 2.8 m with a desk and a screen on it, a chair, a shelf, and two
/// ceiling lights of 1.2 x 0.3 m; 61 polygons in all, two cameras. [Hardt96, figure 7-1]
Scene office();

/// Twenty tiles of 1 m x 1 m, 5 x 4, edge to edge: two meshes in turn, one a single quad and one
/// cut into 3 x 3, so that whole edges meet thirds. A lamp of 0.6 m hangs 2.6 m above them and a
/// pillar throws its shadow over several.
Scene tiled_kit();

/// A house with walls and a roof of 1 cm on a lawn in the sun, without door or window: whatever
/// light a bake finds inside has come through the lightmap. The lawn goes on under the walls and
/// the roof's underside over them; the house stands askew on the lawn. Two cameras.
Scene closed_corner();

/// Twigs of leaves over a floor of 3 x 3 m, under a sun and a sky: cards with a leaf's picture
/// whose mask has holes, double-sided, which scatter light through themselves.
Scene foliage();

/// A floor of 1.5 x 1.5 m with 6 x 6 bumps 2 cm high before a wall, between a warm and a cool lamp:
/// flat with a normal map, or in relief, which is what the map stands for.
Scene bumps(bool in_relief);

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
