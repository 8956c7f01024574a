// Everything a user can ask of a bake, as plain data.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "luxel/atlas/atlas.h"
#include "luxel/base/result.h"
#include "luxel/export/attach.h"
#include "luxel/import/import.h"
#include "luxel/light/light_layers.h"
#include "luxel/pipeline/settings/lightmap_files.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/pipeline/settings/solver_settings.h"
#include "luxel/solve/gather/gather.h"

namespace luxel::pipeline {

/// The form of a lightmap's light directions; luxel/pipeline/bake/light_directions.h.
enum class Directional : uint8_t { none, dominant, sh1 };

/// The light that a lightmap holds. Direct light has met no surface since it left its source.
enum class LightPart : uint8_t {
  all,
  direct,       ///< straight from lights, surfaces that shine, background and environment
  indirect,     ///< reflected or scattered at least once
  no_punctual,  ///< all but what comes straight from point, spot and directional lights
};

/// A picture has four channels.
inline constexpr size_t kMaxMaskedLights = 4;

/// The quality of light as a word; luxel/pipeline/settings/quality.h has the numbers. `none`: by
/// numbers alone.
enum class Quality : uint8_t { none, draft, good, best };

/// The number of lightmaps that a bake leaves. The scene is laid out anew for more than one, and
/// for a number that is not known yet.
struct PagesSetting {
  atlas::PageMode mode = atlas::PageMode::fixed;
  int count = 1;  ///< fixed
};

/// The part of a bake that is done; other processes do the rest (docs/guide/many-machines.md).
struct BakePart {
  int number = 0, of = 0;  ///< 0: all of it is done

  bool is_all() const { return of == 0; }
};

/// Defaults of what solvers are asked for are gather's, the default solver's. Ranges, help and
/// notation of each member stand in the table of options (bake_settings_options.cpp).
struct BakeSettings {
  std::filesystem::path scene;
  std::filesystem::path output;  ///< a folder; made when missing
  std::string solver = "gather";
  SolverSettings own;  ///< settings that only one solver has, by its type
  /// Side of a lightmap in texels; nothing: by the scene (luxel/pipeline/texels/resolution.h).
  std::optional<int> resolution;
  float texels_per_metre = 0;  ///< > 0: chooses the resolution; with automatic pages their number
  PagesSetting pages;
  atlas::UvMode uv = atlas::UvMode::automatic;
  /// The argument of set_quality(). The numbers below count, whatever it says.
  Quality quality = Quality::none;
  int samples = gather::GatherParams{}.samples;  ///< rays or paths per texel
  /// Shadow rays per texel towards area lights; nothing: first_direct_samples(), and with gather
  /// more where direct light is not as well known as the rest.
  std::optional<int> direct_samples = gather::GatherParams{}.direct_samples;
  /// Rays are added until the light errs by less than this, and `samples` is ignored; 0: no more
  /// than `samples`.
  double max_error = 0;
  gather::ErrorMeasure error_measure = gather::ErrorMeasure::p95;
  /// > 0: as good as it gets in about so many seconds, `samples` is not looked at; with max_error
  /// until either is reached. The result depends on how fast the machine is.
  double time_budget_s = 0;
  bool samples_given = false;  ///< beside max_error or time_budget_s, which win: worth a warning
  /// Points per texel where direct light varies, 1: none; nothing: first_supersample(), and more as
  /// above.
  std::optional<int> supersample = 16;
  int bounces = gather::GatherParams{}.bounces;  ///< < 0: all
  uint64_t max_memory_bytes = 0;  ///< 0: four fifths of what is free when the bake starts
  uint64_t seed = gather::GatherParams{}.seed;
  int threads = 0;  ///< 0: all cores
  import::ImportParams reading;
  OutsideLight outside;
  Directional directional = Directional::none;
  double probe_spacing_m = 0;                        ///< 0: no probes
  light::LayerMode layers = light::LayerMode::none;  ///< lightmaps per light, too
  LightPart light = LightPart::all;
  std::string shadow_mask;          ///< names of lights with commas between, or "auto"; empty: none
  double occlusion_distance_m = 0;  ///< of ambient occlusion, may be infinite; 0: none
  bool denoise = false;             ///< take the grain out of texels, docs/method/denoise.md
  bool stitch = true;               ///< make charts agree along seams
  bool repair_leaks = true;         ///< cut charts at thin walls, move samples out of solids
  export_::Attach attach = export_::Attach::lightmap;  ///< the way that baked.glb shows the light
  bool vertex_colors = false;  ///< baked.glb: light per vertex of the solver's mesh in COLOR_0
  bool texels = false;         ///< texels.png too
  bool error_map = false;      ///< error.png too
  LightmapFormats formats;     ///< files beside lightmap.exr
  bool html = false;           ///< view.html too
  std::string view;  ///< of preview.png and view.html: CameraChoice::view (bake/camera.h); empty:
                     ///< the scene's first camera, else a fitted one
  /// Finished parts are kept once the bake has taken so long [s], docs/method/checkpoints.md; 0:
  /// never.
  double checkpoint_s = 30;
  bool resume = false;  ///< go on with what another bake has kept
  BakePart part;
  /// Files with parts of this bake that are finished. No option: `luxel merge` has them.
  std::vector<std::filesystem::path> parts;
  bool keep = false;  ///< build on the bake in DIR/cache, or leave one there; docs/method/rebake.md
};

/// Rays are added in rounds, and `samples` is ignored.
inline bool adds_rounds(const BakeSettings& settings) {
  return settings.max_error > 0 || settings.time_budget_s > 0;
}
/// Shadow rays and points per texel of the first direct light: as set, or as fits the samples.
int first_direct_samples(const BakeSettings& settings);
int first_supersample(const BakeSettings& settings);

/// Checks that options do not contradict each other. Errors (bad_setting) name the options, the
/// values, and a way out. The table of options checks the values themselves.
Status check_contradictions(const BakeSettings& settings);

/// The value of --directional that stands for it.
std::string_view name_of(Directional directional);
/// The value of --layers that stands for it.
std::string_view name_of(light::LayerMode mode);
/// "auto", "mesh" or a number, and back.
Result<PagesSetting> parse_pages(std::string_view text);
/// The value of --pages that stands for it: parse_pages() gives it back.
std::string text_of(const PagesSetting& pages);
/// "1500000", "900M", "1.5G": bytes; K, M, G, T are powers of 1024.
Result<uint64_t> parse_size(std::string_view text);
/// "3/16": the third of 16 parts.
Result<BakePart> parse_part(std::string_view text);
/// "inf" or a number >= 0; inf is -1.
Result<int> parse_bounces(std::string_view text);
/// "inf" or a number > 0.
Result<double> parse_distance(std::string_view text);
/// The value of --shadow-mask, of four names at most.
Result<std::string> parse_shadow_mask(std::string_view text);
/// The value of --light that stands for it.
std::string_view name_of(LightPart part);

}  // namespace luxel::pipeline
