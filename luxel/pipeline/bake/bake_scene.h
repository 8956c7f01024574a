// A scene in, its light in memory out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/export/view_page.h"
#include "luxel/image/codec.h"
#include "luxel/pipeline/bake/layers.h"
#include "luxel/pipeline/bake/light_directions.h"
#include "luxel/pipeline/bake/surface_maps.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/solver/plan.h"
#include "luxel/pipeline/solver/solvers.h"
#include "luxel/pipeline/texels/texel_layout.h"
#include "luxel/post/seams.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

class BakeCache;
class Checkpoint;

/// Objects that outlive a bake, or outlived the one before; null where there is none.
struct Keepers {
  Checkpoint* checkpoint = nullptr;  ///< a bake on a device keeps nothing there
  BakeCache* cache = nullptr;
  const BakeDevice* device = nullptr;
  Team* team = nullptr;  ///< see bake_scene()
};

/// A finished bake in memory, before anything is written.
struct Bake {
  scene::Scene scene;            ///< as baked: outside light added, charts cut
  size_t triangles_of_file = 0;  ///< drawn ones, before backs were added and charts cut
  atlas::Atlas atlas;
  atlas::TexelMap map;
  atlas::AtlasStats atlas_stats;
  std::optional<WrongSides> wrong_in_uv1;  ///< Sides::wrong_in_uv1
  TexelLight light;
  std::vector<image::Image> lightmaps;  ///< E, 4 channels, per page as lightmap.exr holds it
  /// lightmap.exr of each page where a team has made them together; else empty.
  std::vector<std::vector<std::byte>> lightmap_exr;
  std::vector<image::Image> shown;       ///< for viewers (shown_light.h); empty: the same
  std::vector<BakedLayer> layers;        ///< with --layers
  std::vector<SurfaceMap> surface_maps;  ///< with --shadow-mask, --ambient-occlusion
  image::Image8 preview;
  DirectionMaps directions;         ///< with --directional
  std::optional<ProbeGrid> probes;  ///< with --probes
  export_::View view;               ///< what the preview was taken with
  size_t seams = 0;
  LeakRepair repair;
  std::vector<image::Image8> texel_pictures;  ///< per page, with --texels
  std::vector<image::Image8> error_pictures;  ///< per page, with --error-map
  post::SeamResidual seam_residual_before, seam_residual_after;
  std::vector<std::string> warnings;
};

/// Gets the light of gather as it grows, one value per texel of the map, neither refilled nor
/// stitched. The bake goes on when it returns.
using OnBakeEstimate = std::function<void(const light::TexelScene&, const light::LightEstimate&)>;

/// Callbacks to those who watch a bake; empty: nobody watches.
struct BakeObserver {
  /// Gets the scene when it is read, its outside light added, and not yet laid out.
  std::function<void(const scene::Scene&)> on_read{};
  OnBakeEstimate on_estimate{};
  /// With on_estimate: the guess that light begins with, E per element after all bounces, from its
  /// direct part; and whether light of an element should come early.
  std::function<std::vector<Rgb>(const light::TexelScene&, std::span<const Rgb> direct)> guess{};
  std::function<bool(const light::TexelScene&, size_t element)> is_watched{};
  /// With on_estimate: light::OnBounce of gather, neither refilled nor stitched.
  std::function<bool(const light::TexelScene&, std::span<const Rgb>)> on_bounce{};
  /// Makes who watches hemicube in the scene as it is laid out, which lives as long as the bake.
  std::function<hemicube::Observer(const light::TexelScene&)> hemicube{};
};

/// Reads settings.scene and adds its outside light. `warnings` gets what is to be told. Errors:
/// those of files and of outside light; cancelled.
Result<scene::Scene> load_scene(const BakeSettings& settings, std::vector<std::string>& warnings,
                                Progress& progress);

/// Imports, lays out, solves, repairs and draws. Nothing is written but temporary files without a
/// name in or above settings.output, and the checkpoint and the cache, if there are any. The
/// members of keepers.team share the work out; all but the first end with ErrorCode::parts_missing
/// then, for the rest is the first one's. Errors: whatever the stages say; settings out of range;
/// settings that a device does not know.
Result<Bake> bake_scene(const BakeSettings& settings, Progress& progress,
                        const Keepers& keepers = {}, const BakeObserver& observer = {});

/// Bakes a scene that a program has built: settings.scene is not looked at. The scene is validated
/// first (luxel/scene/validate.h). Nothing is written but temporary files in or above
/// settings.output, the folder of the process if that is empty. The result stands by itself:
/// Bake::lightmaps has E [W/m^2], Bake::atlas where it lies. Errors: settings out of range
/// (bad_setting), a scene that cannot be repaired (bad_input), too little memory, cancelled.
Result<Bake> bake_scene(scene::Scene scene, const BakeSettings& settings, Progress& progress,
                        const BakeObserver& observer = {});

/// Bakes a scene that has its outside light, as BakeObserver::on_read got one: nothing is added,
/// and one without any light stays dark. Otherwise as above.
Result<Bake> bake_read_scene(scene::Scene scene, const BakeSettings& settings, Progress& progress,
                             const Keepers& keepers = {}, const BakeObserver& observer = {});

/// `luxel bake --plan`: reads and lays out, and tries a few texels. Nothing is written.
Result<Plan> plan_bake(const BakeSettings& settings, Progress& progress);

}  // namespace luxel::pipeline
