// The whole of `luxel bake`: a scene in, files out.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

struct Bake;
struct BakeDevice;

/// bake_scene(), then lightmap.exr (and its other formats), baked.glb,
/// preview.png, texels.png, error.png, view.html when asked for, and bake.json in settings.output,
/// all of them or none. Of several pages they are lightmap-0.exr and so on; with --layers there is
/// a lightmap-LAYER.exr of each besides. Returns what bake.json holds. A bake that does not come to
/// its end leaves its checkpoint, nothing else; one that does leaves DIR/cache with settings.keep.
/// A bake on a `device` keeps nothing in a checkpoint; null: the processor's. A part of a bake
/// (settings.part) leaves the file of that part alone, and returns {"part": ...} about it.
///
/// The members of a `team` call this together, with the same settings: they share the work out, the
/// first one writes what comes of it, and the others get {}. Null: there is none.
Result<nlohmann::json> bake(const BakeSettings& settings, Progress& progress,
                            const BakeDevice* device = nullptr, Team* team = nullptr);

/// Writes what bake() leaves of a bake that bake_scene() made, whose stages are those of `baked`.
/// Returns what bake.json holds. Errors: those of files; cancelled.
Result<nlohmann::json> save_bake(const BakeSettings& settings, const Bake& bake,
                                 const Progress& baked, Progress& progress);

}  // namespace luxel::pipeline
