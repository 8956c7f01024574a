// A baked scene as one page to walk around in, view.html.
#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "luxel/base/result.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

/// The camera, size and exposure of a picture, enough to show it again.
struct View {
  scene::Camera camera;
  int width = 0, height = 0;  ///< of the picture
  float exposure = 1;         ///< factor of the radiance before the tone curve
};
/// {"width", "height", "exposure", "camera": {"matrix": 16 numbers, column by column, "yfov",
/// "aspect", "height_m"}}: `matrix` is world from camera (looks along -z, +y up), `yfov` in
/// radians, `aspect` 0 where the camera leaves it to the picture, `height_m` > 0 for an
/// orthographic camera. `origin`: Scene::origin of the camera's scene; the matrix stands in the
/// world of its file.
nlohmann::json to_json(const View& view, DVec3 origin = {});
/// Reads the output of to_json(); none where `json` is something else.
std::optional<View> view_of_json(const nlohmann::json& json, DVec3 origin = {});

struct ViewPage {
  std::string title;
  View view;                                ///< what is shown first
  Rgb background;                           ///< radiance where there is no surface
  size_t triangles = 0;                     ///< for the reader
  std::span<const std::byte> glb;           ///< of baked_glb()
  std::span<const image::Image> lightmaps;  ///< E, 4 channels, the pages of `glb`
  /// Picture behind the background's radiance; nullptr or empty: nothing. The page carries it
  /// kSurroundingsWidth pixels wide, or as it is where it is narrower.
  const scene::Environment* environment = nullptr;
  /// The page carries these instead of `lightmaps`, with a slider and a colour for each.
  std::span<const LightmapLayer> layers = {};
};
inline constexpr int kSurroundingsWidth = 512;

/// Ok where luxel was built with the page. The error says what to install.
Status check_view_page();

/// The whole page: a program (three.js and export/web/), the scene, its lightmaps and surroundings
/// as 16-bit floats, all deflated. It fetches nothing. Surfaces show base colour * (1 - metallic) *
/// E / pi + emission through the curve of display::compress, back faces of one-sided materials are
/// left out and alpha masks cut, as display::draw does. Errors: check_view_page's; out of memory.
Result<std::string> view_html(const ViewPage& page);

}  // namespace luxel::export_
