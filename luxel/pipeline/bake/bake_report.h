// The report on a bake in bake.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {

/// Settings, counts, seconds, what is known of errors, seams and leaks: docs/format/bake.md has the
/// keys. `progress` is that of the finished bake.
nlohmann::json bake_report(const BakeSettings& settings, const Bake& bake,
                           const Progress& progress);

/// The least part of the texels that holds 99 % of the light of all, hidden ones aside; 1 where
/// there is none.
inline constexpr double kLitPart = 0.99;
double lit_share(const TexelLight& light);

}  // namespace luxel::pipeline
