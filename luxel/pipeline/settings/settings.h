// Everything a user can ask of a bake, as plain data.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/result.h"
#include "luxel/base/vec.h"
#include "luxel/light/light_layers.h"
#include "luxel/pipeline/settings/ies_setting.h"
#include "luxel/pipeline/settings/lightmap_files.h"
#include "luxel/pipeline/settings/sky_setting.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Where the sun stands and how strong it is.
struct Sun {
  float azimuth_deg = 0;     ///< compass bearing: 0 north = -Z, 90 east = +X
  float elevation_deg = 45;  ///< above the horizon, Y being up
  float lux = 0;             ///< E on a surface that faces it [W/m^2 or lux]
};

/// A picture of the surroundings.
struct EnvironmentSetting {
  std::filesystem::path file;
  float rotation_deg = 0;  ///< about the vertical, as a compass turns
  float scale = 1;         ///< of its radiance
};

/// Light that the scene's file does not have.
struct OutsideLight {
  std::optional<EnvironmentSetting> environment;
  std::optional<Rgb> background;  ///< radiance of the surroundings; replaces the file's
  std::optional<Sun> sun;
  std::optional<SkySetting> sky;  ///< with its own sun
  std::vector<IesSetting> ies;    ///< add_profiles() reads them
};

/// What only the hemicube solver reads.
struct HemicubeSettings {
  std::string elements = "vertex";  ///< or "triangle"
  int resolution = 64;              ///< pixels along an edge of the hemicube's top, even
  double element_size_m = 0;        ///< legs of the first triangles; 0: by max_elements
  int64_t max_elements = 0;         ///< 0: 20,000, or more when the scene has many itself
  double max_error = 0.01;          ///< cut where interpolation errs by more; 0: nowhere
  bool smooth = false;              ///< triangle: interpolate between middles
};

/// What the matrix solver and relighting read.
struct MatrixSettings {
  int64_t patches = 8192;  ///< about so many pieces of surface exchange light
  int rays = 2048;         ///< per patch, to find what it sees
};

/// What hierarchical radiosity reads.
struct HierarchicalSettings {
  std::optional<double> eps;    ///< how much a link may err [W/m^2]; nothing: by the light there is
  double min_area_m2 = 0;       ///< elements are not divided below; 0: by the scene
  bool discontinuities = true;  ///< edges of shadows become edges of the mesh
  int max_leaf_lines = 10;      ///< discontinuities through an element, at most
  std::optional<double> min_weight;  ///< weaker ones are left out [W/m^2 per m; nearness W/m^2]
  std::string ranking = "slope";     ///< or nearness: which discontinuities come first
};

/// How a lightmap says where its light comes from; luxel/pipeline/bake/light_directions.h.
enum class Directional : uint8_t { none, dominant, sh1 };
/// "dominant" or "sh1".
Result<Directional> parse_directional(std::string_view text);
std::string_view name_of(Directional directional);

/// How many lightmaps a bake leaves. More than one, or not yet known how many: the scene is laid
/// out anew.
struct PagesSetting {
  atlas::PageMode mode = atlas::PageMode::fixed;
  int count = 1;  ///< fixed
};
/// "auto", "mesh" or a number.
Result<PagesSetting> parse_pages(std::string_view text);

/// "per-light" or "groups".
Result<light::LayerMode> parse_layers(std::string_view text);

struct BakeSettings {
  std::filesystem::path scene;
  std::filesystem::path output;  ///< a folder; made when missing
  std::string solver = "gather";
  int resolution = 512;        ///< side of a lightmap in texels
  float texels_per_metre = 0;  ///< > 0: chooses the resolution; with automatic pages their number
  PagesSetting pages;
  atlas::UvMode uv = atlas::UvMode::automatic;
  int samples = 256;
  int direct_samples = 64;
  /// gather: rays are added until the 95th percentile of the relative standard error over texels is
  /// below this, and `samples` is ignored; 0: no more than `samples`.
  double max_error = 0;
  /// gather, > 0: as good as it gets in about so many seconds, `samples` is not looked at; with
  /// max_error until either is reached. The result depends on how fast the machine is.
  double time_budget_s = 0;
  bool samples_given = false;     ///< beside max_error or time_budget_s, which win: worth a warning
  int supersample = 16;           ///< points per texel where direct light varies; 1: none
  int bounces = -1;               ///< < 0: all
  uint64_t max_memory_bytes = 0;  ///< 0: four fifths of what is free when the bake starts
  uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores
  OutsideLight outside;
  HemicubeSettings hemicube;
  MatrixSettings matrix;
  HierarchicalSettings hierarchical;
  Directional directional = Directional::none;
  double probe_spacing_m = 0;                        ///< 0: no probes
  light::LayerMode layers = light::LayerMode::none;  ///< lightmaps per light, too
  bool denoise = false;        ///< take the grain out of texels, docs/method/denoise.md
  bool stitch = true;          ///< make charts agree along seams
  bool repair_leaks = true;    ///< cut charts at thin walls, move samples out of solids
  bool vertex_colors = false;  ///< baked.glb: light per vertex of the solver's mesh in COLOR_0
  bool texels = false;         ///< texels.png too
  bool error_map = false;      ///< error.png too
  LightmapFormats formats;     ///< files beside lightmap.exr
  bool html = false;           ///< view.html too
  /// Finished parts are kept once the bake has taken so long [s], docs/method/checkpoints.md; 0:
  /// never.
  double checkpoint_s = 30;
  bool resume = false;  ///< go on with what another bake has kept
  bool keep = false;  ///< build on the bake in DIR/cache, or leave one there; docs/method/rebake.md
};

/// Checks every number against its range, and options against each other. Errors (bad_setting) name
/// the option, the value, and what works. Whether the solver can do what is asked:
/// solver/check_settings.h.
Status check_values(const BakeSettings& settings);

Status check(const HemicubeSettings& settings);
Status check(const MatrixSettings& settings);
Status check(const HierarchicalSettings& settings);

nlohmann::json to_json(const BakeSettings& settings);

/// "r,g,b", three numbers >= 0.
Result<Rgb> parse_background(std::string_view text);
/// "FILE", "FILE,rotate_deg" or "FILE,rotate_deg,scale".
Result<EnvironmentSetting> parse_environment(std::string_view text);
/// "azimuth_deg,elevation_deg,lux".
Result<Sun> parse_sun(std::string_view text);
/// "1500000", "900M", "1.5G": bytes; K, M, G, T are powers of 1024.
Result<uint64_t> parse_size(std::string_view text);
/// "inf" or a number >= 0; inf is -1.
Result<int> parse_bounces(std::string_view text);

/// The sun's disc is half a degree wide: its shadows have penumbrae.
scene::PunctualLight sun_light(const Sun& sun);

/// Adds profiles of lamps, environment or sky, background and sun to a scene; an environment or a
/// sky without a background beside it replaces the file's background. A scene that then has no
/// light at all gets a white background of radiance 1. Returns warnings; that one comes last.
/// Errors: those of import::read_environment and add_profiles.
Result<std::vector<std::string>> add_outside_light(const OutsideLight& outside,
                                                   scene::Scene& scene);

}  // namespace luxel::pipeline
