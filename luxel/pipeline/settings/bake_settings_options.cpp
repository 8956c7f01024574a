#include "luxel/pipeline/settings/bake_settings_options.h"

#include "luxel/pipeline/settings/import_options.h"
#include "luxel/pipeline/settings/option_rows.h"

namespace luxel::pipeline {
namespace {

using S = BakeSettings;
using BakeRows = Rows<BakeSettings>;
using Can = Capabilities;
using nlohmann::json;

/// Solvers count samples in 16 bits.
constexpr double kMaxSamples = 65535;
/// Lightmaps of more texels do not fit the numbers of a texel.
constexpr double kMaxResolution = 16384;
/// A hundredth of a percent: 100 times the rays of 0.1 %, more than any texel may have.
constexpr double kSmallestError = 1e-4;
/// A few months [s].
constexpr double kLongestBudget_s = 1e7, kShortestBudget_s = 1e-9;
/// 11 days [s]: later than any bake ends.
constexpr double kLongestCheckpoint_s = 1e6;

json json_of_bounces(int bounces) { return bounces < 0 ? json("inf") : json(bounces); }

/// Options for the sampling of light and its quality.
Options<S> sampling_options() {
  return {
      BakeRows::choice(
          "--quality", &S::quality,
          {{"draft", Quality::draft}, {"good", Quality::good}, {"best", Quality::best}},
          "Preset for --samples, --direct-samples, --supersample and --denoise where you do not "
          "set them; default: good")
          .only(&Can::quality)
          .leaves(Changes::nothing),
      BakeRows::number("--samples", &S::samples, {1, kMaxSamples},
                       "Indirect rays per texel; for gather, the default comes from --quality")
          .unit("RAYS")
          .only(&Can::samples),
      BakeRows::number("--direct-samples", &S::direct_samples, {1, kMaxSamples},
                       "Shadow rays per texel to area lights; auto: derived from --samples, so "
                       "that direct light is as accurate as indirect light")
          .unit("RAYS")
          .only(&Can::direct_samples),
      BakeRows::number("--supersample", &S::supersample, {1, 1024},
                       "Points in each texel across which direct light varies; 1: no "
                       "supersampling; auto: derived from --samples")
          .unit("POINTS")
          .only(&Can::supersample),
      BakeRows::text("--bounces", &S::bounces, parse_bounces, json_of_bounces,
                     "Number of bounces, or inf")
          .unit("COUNT"),
      BakeRows::number(
          "--max-error", &S::max_error,
          {kSmallestError, 1, "",
           "a bake to an error of 0 would never end; give the relative error to reach, as 0.02"},
          "Add rays until the relative error of the light is below this, e.g. 0.02")
          .unit("ERROR")
          .only(&Can::errors),
      BakeRows::choice(
          "--error-measure", &S::error_measure,
          {{"p95", gather::ErrorMeasure::p95}, {"rms", gather::ErrorMeasure::rms}},
          "What --max-error limits: p95 (the relative error that 95 % of the texels stay below) or "
          "rms (the root mean square error of all texels, over their mean light)")
          .only(&Can::errors),
      BakeRows::number(
          "--time-budget", &S::time_budget_s,
          {kShortestBudget_s, kLongestBudget_s, "is not a time budget; give seconds, as 60"},
          "Time for the whole bake. gather: reach the lowest error in about this many seconds, or "
          "stop at --max-error; hierarchical: refine less if time is short; all but gather exit "
          "with code 3 when time runs out")
          .key_is("time_budget_s")
          .unit("SECONDS"),
      BakeRows::number("--seed", &S::seed, {0}, "Random seed"),
  };
}

/// Where texels lie.
Options<S> layout_options() {
  return {
      BakeRows::number("--resolution", &S::resolution, {1, kMaxResolution},
                       "Lightmap side in texels; default: as fine as the scene needs, up to about "
                       "2 million texels")
          .unit("TEXELS"),
      BakeRows::number(
          "--texels-per-metre", &S::texels_per_metre,
          {0, kNoLimit, "is not a density; give a number > 0", "", true},
          "Texel density; the lightmap side becomes the smallest power of two that fits the scene")
          .unit("DENSITY"),
      BakeRows::text(
          "--pages", &S::pages, parse_pages, [](auto& p) { return json(text_of(p)); },
          "Number of lightmaps; auto: as many as the density needs; mesh: one per mesh")
          .unit("COUNT|auto|mesh"),
      BakeRows::choice("--uv", &S::uv,
                       {{"auto", atlas::UvMode::automatic},
                        {"keep", atlas::UvMode::keep},
                        {"unwrap", atlas::UvMode::unwrap}},
                       std::string(kUvHelp)),
      BakeRows::toggle("--no-leak-repair", &S::repair_leaks,
                       "Do not cut charts under thin walls or move samples out of solids")
          .key_is("repair_leaks"),
  };
}

/// Options for the results that are made of the light.
Options<S> result_options() {
  return {
      BakeRows::choice("--directional", &S::directional,
                       {{"dominant", Directional::dominant}, {"sh1", Directional::sh1}},
                       "Also write how irradiance changes with the normal, for normal maps: "
                       "dominant (a direction) or sh1 (spherical harmonics)")
          .leaves(Changes::results),
      BakeRows::number("--probes", &S::probe_spacing_m,
                       {0, kNoLimit, "is not a spacing; give metres > 0", "", true},
                       "Also write light probes on a grid of this spacing in metres")
          .key_is("probe_spacing_m")
          .unit("METRES")
          .leaves(Changes::results),
      BakeRows::choice(
          "--layers", &S::layers,
          {{"per-light", light::LayerMode::per_light}, {"groups", light::LayerMode::groups}},
          "Also write a lightmap for each light (per-light), or for each group of lights whose "
          "names differ only in a trailing number (groups)")
          .never_without(&Can::layers)
          .leaves(Changes::results),
      BakeRows::choice("--light", &S::light,
                       {{"all", LightPart::all},
                        {"direct", LightPart::direct},
                        {"indirect", LightPart::indirect},
                        {"no-punctual", LightPart::no_punctual}},
                       "Light in the lightmap: all, direct, indirect (bounced at least once), or "
                       "no-punctual (all but the direct light of point, spot and directional "
                       "lights, for engines that add it themselves)")
          .never_without(&Can::direct),
      BakeRows::text(
          "--shadow-mask", &S::shadow_mask, parse_shadow_mask,
          [](auto& names) { return names.empty() ? json() : json(names); },
          "Also write shadow-mask.png and .exr: how much each texel sees of up to four point, spot "
          "or directional lights; auto: the first four")
          .unit("LIGHT,...|auto")
          .leaves(Changes::results),
      BakeRows::text(
          "--ambient-occlusion", &S::occlusion_distance_m, parse_distance,
          [](double d) { return std::isinf(d) ? json("inf") : json(d); },
          "Also write ambient-occlusion.png and .exr: the share of directions that nothing blocks "
          "within this distance in metres, or inf")
          .key_is("occlusion_distance_m")
          .unit("METRES")
          .leaves(Changes::results),
      BakeRows::toggle("--denoise", &S::denoise, "Denoise the light, and keep shadow edges")
          .never_without(&Can::noise)
          .never_with({"--no-denoise"})
          .leaves(Changes::results),
      BakeRows::toggle("--no-denoise", &S::denoise, "Do not denoise")
          .key_is("")
          .only(&Can::noise)
          .leaves(Changes::results),
      BakeRows::toggle("--no-stitch", &S::stitch, "Do not blend charts along seams")
          .leaves(Changes::results),
      BakeRows::choice(
          "--attach", &S::attach,
          {{"lightmap", export_::Attach::lightmap},
           {"combined", export_::Attach::combined},
           {"emissive", export_::Attach::emissive}},
          "How baked.glb carries the light: lightmap (for viewers that support MOZ_lightmap), or, "
          "for any viewer, combined (unlit colour times light) or emissive (emission)")
          .leaves(Changes::nothing),
      BakeRows::toggle("--vertex-colors", &S::vertex_colors,
                       "Store light per vertex in COLOR_0 of baked.glb instead of the lightmap")
          .never_without(&Can::vertex_light)
          .leaves(Changes::nothing),
      BakeRows::toggle(
          "--texels", &S::texels,
          "Also write texels.png: how each texel was treated (luxel render --technique "
          "texels)")
          .leaves(Changes::nothing),
      BakeRows::toggle(
          "--error-map", &S::error_map,
          "Also write error.png: the relative standard error of each texel (luxel render "
          "--technique error)")
          .only(&Can::errors)
          .leaves(Changes::nothing),
      BakeRows::text(
          "--formats", &S::formats, parse_formats, [](auto& f) { return to_json(f); },
          "Lightmap formats, separated by commas: exr (always written), hdr, rgbm, rgbe, half, "
          "ktx2")
          .unit("LIST")
          .leaves(Changes::nothing),
      BakeRows::toggle("--html", &S::html,
                       "Also write view.html: a single page to walk through the baked scene")
          .leaves(Changes::nothing),
      BakeRows::text(
          "--view", &S::view,
          [](std::string_view text) -> Result<std::string> { return std::string(text); },
          [](const std::string& view) { return view.empty() ? json() : json(view); },
          std::string(kViewHelp))
          .unit("interior|exterior|front|top|CAMERA")
          .leaves(Changes::nothing),
  };
}

/// Options for the run of the bake: memory, threads, checkpoints, parts.
Options<S> running_options() {
  return {
      BakeRows::text(
          "--max-memory", &S::max_memory_bytes, parse_size,
          [](uint64_t bytes) { return json(bytes); }, std::string(kMaxMemoryHelp))
          .key_is("max_memory_bytes")
          .unit("SIZE")
          .leaves(Changes::nothing),
      BakeRows::number("--threads", &S::threads, {0, 1024}, "Number of threads; 0: all cores")
          .leaves(Changes::nothing),
      BakeRows::number("--checkpoint", &S::checkpoint_s,
                       {0, kLongestCheckpoint_s, "", "give seconds; 0 keeps nothing"},
                       "After this many seconds, start to save finished parts in "
                       "FOLDER/checkpoint.luxel, which is removed when the bake is done; 0: never")
          .key_is("checkpoint_s")
          .unit("SECONDS")
          .only(&Can::parts)
          .leaves(Changes::nothing),
      BakeRows::toggle("--resume", &S::resume, "Continue from the checkpoint in the output folder")
          .key_is("")
          .only(&Can::parts)
          .leaves(Changes::nothing),
      BakeRows::text(
          "--part", &S::part, parse_part,
          [](const BakePart& part) {
            return part.is_all() ? json() : json(fmt::format("{}/{}", part.number, part.of));
          },
          "Do only one part of the work, e.g. 3/16 for the third of 16, and leave it in the output "
          "folder; luxel merge finishes the bake")
          .key_is("")
          .unit("K/N")
          .never_without(&Can::parts)
          .leaves(Changes::nothing),
      BakeRows::toggle("--keep", &S::keep,
                       "Reuse the bake kept in FOLDER/cache and retrace only what has changed in "
                       "the scene; if there is none, bake and keep it there")
          .never_without(&Can::keeps)
          .leaves(Changes::nothing),
  };
}

}  // namespace

Options<BakeSettings> bake_settings_options() {
  Options<S> rows;
  for (Options<S>& part :
       std::array{layout_options(), sampling_options(), result_options(), running_options(),
                  options_of_part<S, import::ImportParams>(
                      import_options(), [](S& s) -> import::ImportParams& { return s.reading; }),
                  options_of_part<S, OutsideLight>(
                      outside_light_options(), [](S& s) -> OutsideLight& { return s.outside; })})
    rows.insert(rows.end(), part.begin(), part.end());
  return rows;
}

}  // namespace luxel::pipeline
