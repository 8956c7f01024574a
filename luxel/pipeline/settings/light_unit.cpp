#include "luxel/pipeline/settings/light_unit.h"

#include <vector>

#include "luxel/import/import.h"
#include "luxel/scene/validate.h"

namespace luxel::pipeline {
namespace {

std::string joined(const std::vector<std::string>& parts) {
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : "; ") + part;
  return out;
}

}  // namespace

LightUnit unit_of_light(const std::filesystem::path& file, const scene::Scene& own,
                        const OutsideLight& outside) {
  std::vector<std::string> lux, unknown;
  if (outside.sky) lux.push_back("--sky is in lux");
  if (outside.sun) lux.push_back("--sun is in lux");
  if (!outside.ies.empty()) lux.push_back("IES files are in candela");
  const bool all_by_ies = !outside.ies.empty() && outside.ies.size() >= own.lights.size();
  if (scene::has_light(own) && import::is_gltf_file(file))
    lux.push_back("lights of glTF files are in candela, lux and nits");
  else if (scene::has_light(own) && !all_by_ies)
    unknown.push_back(fmt::format("{} files state no unit of light", file.extension().string()));
  if (outside.background) unknown.push_back("--background states no unit");
  if (outside.environment) unknown.push_back("environment maps state no unit");
  if (!lux.empty() && !unknown.empty())
    return {"lux", joined(lux) + "; " + joined(unknown) + ", so candela and nits are assumed"};
  if (!lux.empty()) return {"lux", joined(lux)};
  if (!unknown.empty())
    return {"W/m^2", joined(unknown) + "; if its values are candela and nits, these are lux"};
  return unit_of_default_day();  // nothing shines
}

LightUnit unit_of_default_day() { return {"lux", "the default sky is in lux"}; }

}  // namespace luxel::pipeline
