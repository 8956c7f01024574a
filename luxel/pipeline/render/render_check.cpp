#include "luxel/pipeline/render/render_check.h"

#include "luxel/base/output_folder.h"
#include "luxel/pipeline/render/techniques.h"
#include "luxel/pipeline/settings/option.h"

namespace luxel::pipeline {
namespace {

constexpr int kMaxPictureSide = 16384, kMaxTileSide = 2048;
constexpr int kMaxPathSamples = 1 << 20;

Status check_output(const RenderSettings& s, const Technique* technique) {
  const std::string extension = s.output.extension().string(), name = s.output.string();
  const bool png = extension == ".png";
  if (!png && extension != ".exr" && extension != ".hdr")
    return fail(ErrorCode::bad_setting, "--output {} is neither .png, .exr nor .hdr", name);
  if (!technique && !png)
    return fail(ErrorCode::bad_setting,
                "--output {}: a contact sheet holds display colours; name it .png", name);
  for (const auto& [option, given] : {std::pair{"--exposure", s.exposure.has_value()},
                                      {"--tone-map", s.tone_map.has_value()},
                                      {"--overlay", !s.overlays.empty()}})
    if (given && !png)
      return fail(ErrorCode::bad_setting,
                  "{} has no effect on {}, which holds light without tone mapping; leave it out, "
                  "or write a .png",
                  option, name);
  return check_output_file(s.output);
}

/// "c, ca, ...": the techniques that have a feature.
std::string users_of(bool Technique::*feature) {
  std::string names;
  for (const Technique& technique : techniques())
    if (technique.*feature) names += (names.empty() ? "" : ", ") + std::string(technique.name);
  return names;
}

/// Refuses settings that the technique would not look at: their user expects something of them.
Status check_used(const RenderSettings& s, const Technique& technique) {
  struct Option {
    std::string name;
    bool given;
    bool Technique::*used;
  };
  const Option options[] = {
      {"--from", !s.from.empty(), &Technique::needs_bake},
      {"--samples", s.samples.has_value(), &Technique::traces_paths},
      {"--seed", s.seed.has_value(), &Technique::traces_paths},
      {"--bounces", s.bounces.has_value(), &Technique::counts_bounces},
      {flags_of(hemicube_options()), s.hemicube.has_value(), &Technique::has_elements},
      {flags_of(hierarchical_options()), s.hierarchical.has_value(), &Technique::has_links},
      {"--overlay", !s.overlays.empty(), &Technique::has_links},
      {"--sun", s.outside.sun.has_value(), &Technique::has_lights}};
  for (const Option& option : options)
    if (option.given && !(technique.*option.used))
      return not_used(fmt::format("--technique {}", technique.name), option.name,
                      users_of(option.used),
                      technique.needs_bake ? "`luxel bake` sets the light of a bake" : "");
  if (technique.show && (s.exposure || s.tone_map))
    return fail(ErrorCode::bad_setting,
                "--technique {} has a scale of its own, so {} has no effect; leave it out",
                technique.name, s.exposure ? "--exposure" : "--tone-map");
  if (technique.needs_bake && !technique.bakes_itself && s.from.empty())
    return fail(ErrorCode::bad_setting,
                "--technique {} draws a bake; name its folder with --from, or use --technique path",
                technique.name);
  return {};
}

}  // namespace

Status check(const RenderSettings& s) {
  const Technique* technique = find_technique(s.technique);
  if (!technique && s.technique != kAllTechniques)
    return fail(ErrorCode::bad_setting, "--technique {} is not known; choose from: {}", s.technique,
                technique_names());
  const int most = technique ? kMaxPictureSide : kMaxTileSide;
  if (s.width < 1 || s.height < 1 || s.width > most || s.height > most)
    return fail(ErrorCode::bad_setting, "--size {}x{} is outside 1x1 to {}x{}", s.width, s.height,
                most, most);
  if (s.samples && (*s.samples < 1 || *s.samples > kMaxPathSamples))
    return fail(ErrorCode::bad_setting, "--samples {} is outside 1 to {}", *s.samples,
                kMaxPathSamples);
  if (s.hemicube) LUXEL_TRY_STATUS(check_all(hemicube_options(), *s.hemicube));
  if (s.hemicube) LUXEL_TRY_STATUS(check_contradictions(*s.hemicube));
  if (s.hierarchical) LUXEL_TRY_STATUS(check_all(hierarchical_options(), *s.hierarchical));
  LUXEL_TRY_STATUS(check_output(s, technique));
  if (technique) return check_used(s, *technique);
  return {};
}

}  // namespace luxel::pipeline
