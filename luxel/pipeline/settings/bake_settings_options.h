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
    "keep = the file's TEXCOORD_1, unwrap = a new layout, auto = keep if it can hold the light";
inline constexpr std::string_view kViewHelp =
    "Where the picture is taken from: inside, outside, the front (looking along -Z), the top, or a "
    "camera of the scene; by default its first, else inside of lit rooms and outside of all else";
inline constexpr std::string_view kMaxMemoryHelp =
    "Memory to stay under, as 900M or 1.5G (default: most of what is free)";

}  // namespace luxel::pipeline
