#include "luxel/pipeline/settings/settings.h"

#include <algorithm>
#include <cmath>

#include "luxel/atlas/pages.h"
#include "luxel/export/view_page.h"
#include "luxel/pipeline/settings/comma_list.h"
#include "luxel/pipeline/settings/option_rows.h"

namespace luxel::pipeline {
namespace {

/// Other options may not contradict --pages.
Status check_pages(const BakeSettings& s) {
  const bool one = s.pages.mode == atlas::PageMode::fixed && s.pages.count == 1;
  if (one) return {};
  const std::string pages = text_of(s.pages);
  if (s.uv == atlas::UvMode::keep)
    return fail(ErrorCode::bad_setting,
                "--uv keep uses the file's layout, which is one lightmap, but --pages {} asks for "
                "others; leave one of them out",
                pages);
  if (s.pages.mode == atlas::PageMode::fixed && s.texels_per_metre > 0)
    return fail(ErrorCode::bad_setting,
                "--texels-per-metre {} and --pages {} both set the number of texels; give --pages "
                "auto, or a --resolution instead of the density",
                s.texels_per_metre, pages);
  return {};
}

/// Options that layers, a lightmap for each light, do not support yet.
Status check_layers(const BakeSettings& s) {
  if (s.layers == light::LayerMode::none) return {};
  const char* other = s.directional != Directional::none ? "--directional"
                      : s.probe_spacing_m > 0            ? "--probes"
                                                         : nullptr;
  if (other)
    return fail(ErrorCode::bad_setting,
                "--layers {} cannot be combined with {}, which needs all light at once; leave one "
                "of them out",
                pipeline::name_of(s.layers), other);
  return {};
}

/// Options that --keep does not support: for a bake that is kept, or built on a kept one.
Status check_keep(const BakeSettings& s) {
  if (!s.keep) return {};
  if (s.resume)
    return fail(ErrorCode::bad_setting,
                "--keep cannot be combined with --resume: a kept bake has no checkpoint; leave one "
                "of them out");
  if (s.time_budget_s > 0)
    return fail(ErrorCode::bad_setting,
                "--keep cannot be combined with --time-budget {}: a kept bake must not depend on "
                "the clock; use --max-error",
                s.time_budget_s);
  return {};
}

/// Options that look at all light at once, or keep it.
Status check_light(const BakeSettings& s) {
  if (s.light == LightPart::all) return {};
  const char* other = s.layers != light::LayerMode::none   ? "--layers"
                      : s.directional != Directional::none ? "--directional"
                      : s.probe_spacing_m > 0              ? "--probes"
                      : s.keep                             ? "--keep"
                                                           : nullptr;
  if (!other) return {};
  return fail(ErrorCode::bad_setting,
              "--light {} cannot be combined with {}, which needs all light; leave one of them out",
              pipeline::name_of(s.light), other);
}

/// Options that parts of a bake cannot have.
Status check_part(const BakeSettings& s) {
  if (s.part.is_all()) return {};
  const std::string part = fmt::format("--part {}/{}", s.part.number, s.part.of);
  if (s.time_budget_s > 0)
    return fail(ErrorCode::bad_setting,
                "{} cannot be combined with --time-budget {}: the parts of a bake must not depend "
                "on the clock; use --max-error or --samples",
                part, s.time_budget_s);
  if (s.keep)
    return fail(ErrorCode::bad_setting,
                "{} cannot be combined with --keep, which needs all rays; leave one of them out",
                part);
  return {};
}

/// baked.glb shows its light in one way.
Status check_attach(const BakeSettings& s) {
  if (s.attach == export_::Attach::lightmap || !s.vertex_colors) return {};
  return fail(ErrorCode::bad_setting,
              "--vertex-colors puts the light of baked.glb into its vertices, and --attach {} into "
              "textures; leave one of them out",
              s.attach == export_::Attach::combined ? "combined" : "emissive");
}

/// Indirect rays for each shadow ray, and for each point; and no fewer of those, and no more.
constexpr int kSamplesPerShadowRay = 4, kFewestShadowRays = 32, kMostShadowRays = 128;
constexpr int kSamplesPerPoint = 16, kFewestPoints = 16, kMostPoints = 64;

}  // namespace

int first_direct_samples(const BakeSettings& s) {
  return s.direct_samples.value_or(
      std::clamp(s.samples / kSamplesPerShadowRay, kFewestShadowRays, kMostShadowRays));
}

int first_supersample(const BakeSettings& s) {
  return s.supersample.value_or(
      std::clamp(s.samples / kSamplesPerPoint, kFewestPoints, kMostPoints));
}

Status check_contradictions(const BakeSettings& s) {
  LUXEL_TRY_STATUS(check_attach(s));
  LUXEL_TRY_STATUS(check_light(s));
  LUXEL_TRY_STATUS(check_pages(s));
  LUXEL_TRY_STATUS(check_layers(s));
  LUXEL_TRY_STATUS(check_keep(s));
  LUXEL_TRY_STATUS(check_part(s));
  return s.html ? export_::check_view_page() : Status{};
}

std::string_view name_of(Directional directional) {
  return directional == Directional::sh1        ? "sh1"
         : directional == Directional::dominant ? "dominant"
                                                : "none";
}

std::string_view name_of(light::LayerMode mode) {
  return mode == light::LayerMode::per_light ? "per-light"
         : mode == light::LayerMode::groups  ? "groups"
                                             : "none";
}

std::string_view name_of(LightPart part) {
  return part == LightPart::direct        ? "direct"
         : part == LightPart::indirect    ? "indirect"
         : part == LightPart::no_punctual ? "no-punctual"
                                          : "all";
}

std::string text_of(const PagesSetting& pages) {
  return pages.mode == atlas::PageMode::automatic      ? "auto"
         : pages.mode == atlas::PageMode::per_instance ? "mesh"
                                                       : fmt::format("{}", pages.count);
}

Result<BakePart> parse_part(std::string_view text) {
  constexpr int kMostParts = 500;  // a process has the files of all of them open
  const size_t slash = text.find('/');
  if (slash != std::string_view::npos) {
    const auto number = number_from<int>(text.substr(0, slash)),
               of = number_from<int>(text.substr(slash + 1));
    if (number && of && *number >= 1 && *number <= *of && *of <= kMostParts)
      return BakePart{*number, *of};
  }
  return fail(ErrorCode::bad_setting,
              "--part {} is not a part of a bake; give its number and the number of parts, as "
              "3/16, with {} parts at most",
              text, kMostParts);
}

Result<PagesSetting> parse_pages(std::string_view text) {
  if (text == "auto") return PagesSetting{atlas::PageMode::automatic, 1};
  if (text == "mesh") return PagesSetting{atlas::PageMode::per_instance, 1};
  const auto count = number_from<double>(text);
  if (!count || *count < 1 || *count > atlas::kMaxPages || *count != std::floor(*count))
    return fail(ErrorCode::bad_setting,
                "--pages '{}' is not a number of lightmaps; give 1 to {}, auto for as many as it "
                "takes, or mesh for one per mesh",
                text, atlas::kMaxPages);
  return PagesSetting{atlas::PageMode::fixed, int(*count)};
}

Result<uint64_t> parse_size(std::string_view text) {
  std::string_view number = text;
  double unit = 1;
  const size_t power =
      text.empty() ? std::string_view::npos : std::string_view("KMGTkmgt").find(text.back());
  if (power != std::string_view::npos) {
    unit = std::pow(1024.0, double(power % 4 + 1));
    number.remove_suffix(1);
  }
  const auto value = number_from<double>(number);
  if (!value || *value * unit < 1 || *value * unit > 1e18)
    return fail(ErrorCode::bad_setting,
                "--max-memory '{}' is not a size; give bytes, or 900M, 1.5G", text);
  return uint64_t(*value * unit);
}

Result<int> parse_bounces(std::string_view text) {
  if (text == "inf") return -1;
  const auto value = number_from<double>(text);
  if (!value || *value < 0 || *value > 1e6 || *value != std::floor(*value))
    return fail(ErrorCode::bad_setting,
                "--bounces '{}' is not a number of bounces; give 0, 1, 2, ... or inf", text);
  return int(*value);
}

Result<double> parse_distance(std::string_view text) {
  if (text == "inf") return INFINITY;
  const auto value = number_from<double>(text);
  if (!value || *value <= 0)
    return fail(ErrorCode::bad_setting,
                "--ambient-occlusion '{}' is not a distance; give metres > 0, or inf", text);
  return *value;
}

Result<std::string> parse_shadow_mask(std::string_view text) {
  const std::vector<std::string_view> names = split_at_commas(text);
  const bool empty = std::ranges::any_of(names, &std::string_view::empty);
  if (text.empty() || empty || names.size() > kMaxMaskedLights)
    return fail(ErrorCode::bad_setting,
                "--shadow-mask '{}': give auto, or the names of one to four lights with commas "
                "between them",
                text);
  return std::string(text);
}

}  // namespace luxel::pipeline
