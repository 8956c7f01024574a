#include "luxel/pipeline/settings/ies_setting.h"

#include <algorithm>

#include "luxel/base/text_tables.h"
#include "luxel/import/ies.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::pipeline {
namespace {

bool can_have(const scene::PunctualLight& light) { return scene::can_have_profile(light.kind); }

/// "'a', 'b' and 7 more"
std::string names_of_lights(const scene::Scene& scene) {
  constexpr size_t kShown = 20;
  std::vector<std::string> names;
  for (const scene::PunctualLight& light : scene.lights)
    if (can_have(light) && std::find(names.begin(), names.end(), light.name) == names.end())
      names.push_back(light.name);
  std::string out;
  for (size_t i = 0; i < std::min(names.size(), kShown); ++i)
    out += fmt::format("{}'{}'", i ? ", " : "", names[i]);
  if (names.size() > kShown) out += fmt::format(" and {} more", names.size() - kShown);
  return out;
}

}  // namespace

Result<IesSetting> parse_ies_setting(std::string_view text) {
  const size_t equals = text.find('=');
  IesSetting out;
  if (equals != std::string_view::npos) {
    out.light = text.substr(0, equals);
    std::string_view file = text.substr(equals + 1);
    const size_t comma = file.rfind(',');
    if (comma != std::string_view::npos) {
      if (const Result<double> scale = luxel::parse_number(file.substr(comma + 1))) {
        if (!(*scale >= 0 && *scale <= 1e9))
          return fail(ErrorCode::bad_setting, "--ies '{}': the scale {} is outside 0 to 1e9", text,
                      *scale);
        out.scale = float(*scale), file = file.substr(0, comma);
      }
    }
    out.file = file;
  }
  if (out.light.empty() || out.file.empty())
    return fail(ErrorCode::bad_setting,
                "--ies '{}' is not LIGHT=FILE or LIGHT=FILE,SCALE, as in --ies desk=spot.ies",
                text);
  return out;
}

Result<std::vector<std::string>> add_profiles(std::span<const IesSetting> settings,
                                              scene::Scene& scene) {
  std::vector<std::string> warnings;
  std::vector<std::string> seen;
  for (const IesSetting& s : settings) {
    if (std::find(seen.begin(), seen.end(), s.light) != seen.end())
      return fail(ErrorCode::bad_setting, "--ies {}={}: this light already has another file",
                  s.light, s.file.string());
    seen.push_back(s.light);
    LUXEL_TRY(const import::Ies ies, import::read_ies(s.file));
    warnings.insert(warnings.end(), ies.warnings.begin(), ies.warnings.end());
    size_t found = 0;
    for (size_t i = 0; i < scene.lights.size(); ++i) {
      if (scene.lights[i].name != s.light || !can_have(scene.lights[i])) continue;
      scene::attach_profile(scene, i, ies.profile, s.scale);
      ++found;
    }
    if (found > 0) continue;
    const std::string names = names_of_lights(scene);
    return fail(ErrorCode::bad_setting, "--ies {}={}: no point or spot light has this name; {}{}",
                s.light, s.file.string(),
                names.empty() ? "the scene has no such lights" : "choose from: ", names);
  }
  return warnings;
}

}  // namespace luxel::pipeline
