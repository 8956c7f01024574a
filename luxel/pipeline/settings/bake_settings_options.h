// The table of a bake's options that are not one solver's own.
#pragma once

#include "luxel/pipeline/settings/option.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// In the order of --help; those of light from outside come last. The scene, the output and actions
/// (--plan, --settings) are the command's.
Options<BakeSettings> bake_settings_options();

/// Options that other commands share with a bake.
inline constexpr std::string_view kUvHelp =
    "Lightmap layout: keep (the file's TEXCOORD_1), unwrap (a new layout), or auto (keep if it can "
    "hold the light, else unwrap)";
inline constexpr std::string_view kViewHelp =
    "Viewpoint of the picture: interior, exterior, front (looking along -Z), top, or a camera of "
    "the scene; default: its first camera, else interior for lit rooms and exterior for other "
    "scenes";
inline constexpr std::string_view kMaxMemoryHelp =
    "Memory limit, e.g. 900M or 1.5G (default: most of the free memory)";

}  // namespace luxel::pipeline
