#include "luxel/pipeline/bake/bake_device.h"

#include <algorithm>

#include "luxel/pipeline/solver/on_device.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {
namespace {

/// The option that only the processor knows; empty: there is none.
std::string only_on_the_processor(const BakeSettings& settings) {
  if (!find_solver(settings.solver)->can.device) return "--solver " + settings.solver;
  if (settings.keep) return "--keep";
  if (settings.resume) return "--resume";
  if (settings.layers != light::LayerMode::none)
    return fmt::format("--layers {}", name_of(settings.layers));
  if (settings.light != LightPart::all) return fmt::format("--light {}", name_of(settings.light));
  return {};
}

}  // namespace

Result<Keepers> settle_device(const BakeSettings& settings, const Keepers& keepers,
                              std::vector<std::string>& warnings) {
  if (!keepers.device) return keepers;
  const std::string option = only_on_the_processor(settings);
  if (option.empty()) return keepers;
  const std::string why = option + " runs on the processor only";
  if (!keepers.device->is_optional)
    return fail(ErrorCode::bad_setting, "{}; leave out {} or --device", why, option);
  warnings.push_back(warning_without(*keepers.device, why));
  Keepers out = keepers;
  out.device = nullptr;
  return out;
}

}  // namespace luxel::pipeline
