// Where texels lie, such that none of them lets light through a wall.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/texels/wrong_sides.h"
#include "luxel/post/refill.h"
#include "luxel/post/seams.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

/// Leaks that were found and repaired; docs/method/leaks.md. Texels are indices into
/// TexelMap::texels.
struct LeakRepair {
  uint32_t cuts = 0;                  ///< planes along which charts were cut
  size_t parted = 0;                  ///< pairs of texels that still mix across a barrier
  std::vector<uint32_t> overlapping;  ///< that belong to more than one chart
  std::vector<uint32_t> moved;        ///< samples moved out of solids
  std::vector<uint32_t> refilled;     ///< inside solids, with the light of their neighbours
};

/// A scene laid out in texels, and what was repaired on the way.
struct TexelLayout {
  atlas::Atlas atlas;
  atlas::TexelMap map;
  atlas::AtlasStats stats;
  trace::RayTracer tracer;  ///< of the scene as it is now
  LeakRepair repair;
  std::vector<uint32_t> near_back_faces;  ///< MovedSamples::near_back_faces
  // Results of split_sides(), from before the scene was laid out:
  std::optional<WrongSides> wrong_in_uv1;
  std::vector<std::string> warnings;
};

/// Lays the scene out and rasterises it; settings.resolution is settled (resolution.h). With
/// settings.repair_leaks, samples move out of solids, and where barriers stand on charts
/// (luxel/transport/barriers.h) the scene's triangles are cut along them and laid out anew, unless
/// TEXCOORD_1 is kept. `scene` changes by these cuts and must stay where it is while the tracer is
/// used. The members of a team share out what asks for rays. Errors: no memory, cancelled, another
/// member of the team gives up.
Result<TexelLayout> lay_out_texels(const BakeSettings& settings, scene::Scene& scene,
                                   Progress& progress, Team* team = nullptr);

/// A layout that is kept for later bakes: of what it is made, and what it became.
struct KeptLayout {
  std::vector<scene::Mesh> meshes;  ///< backs added, cut along barriers
  /// One-sided copies of materials, at the end of all, for surfaces with backs: of which each is.
  std::vector<uint32_t> one_sided_of;
  std::vector<uint32_t> mesh_of_instance;
  atlas::Atlas atlas;
  std::vector<atlas::Texel> texels;  ///< of the map
  atlas::AtlasStats stats;
  LeakRepair repair;
  std::vector<uint32_t> near_back_faces;  ///< TexelLayout::near_back_faces
  std::vector<WrongSides> wrong_in_uv1;   ///< TexelLayout::wrong_in_uv1: one or none
  std::vector<std::string> warnings;
};
/// `one_sided_of` is not filled in.
KeptLayout keep_layout(const scene::Scene& scene, const TexelLayout& layout);

/// The kept layout for `scene`, which has the same meshes, as they were read, in the same number of
/// places. Rays meet something else than then within `boxes` alone; without any its texels' samples
/// stay, else they are moved out of solids again where settings.repair_leaks says so. `scene` gets
/// the layout's meshes. Errors: no memory.
Result<TexelLayout> lay_out_again(const BakeSettings& settings, KeptLayout kept,
                                  std::span<const Box3> boxes, scene::Scene& scene,
                                  Progress& progress);

/// The test for a barrier between two texels of one chart. It refers to the arguments.
post::Parted parted_texels(const scene::Scene& scene, const atlas::Atlas& atlas,
                           const atlas::TexelMap& map, const trace::RayTracer& tracer);

/// Seams without the stretches on which a barrier stands: there light differs for good. The members
/// of a team share the seams out. Errors: cancelled, another member of the team gives up.
Result<std::vector<post::Seam>> open_seams(const scene::Scene& scene, const atlas::Atlas& atlas,
                                           const trace::RayTracer& tracer,
                                           std::span<const post::Seam> seams, Progress& progress,
                                           Team* team = nullptr);

}  // namespace luxel::pipeline
