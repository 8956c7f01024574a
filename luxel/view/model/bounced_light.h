// Light told apart by how often it was reflected.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/image/half.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// E per page of the lightmap.
using PagesOfHalves = std::vector<image::HalfImage>;

/// The light of a lightmap that has at most 0, 1, 2, ... reflections behind it.
struct BouncedLight {
  std::vector<PagesOfHalves> after;
  bool is_draft = false;  ///< coarser than the rest of the light
};

/// The part of `all`, the newest light, that `light` asks for, by the reflections in `bounced`.
/// Never negative, though subtracted light may come of other rays. Errors (bad_setting): more
/// reflections than are told apart.
Result<std::vector<image::Image>> part_of(const LightShown& light, const BouncedLight& bounced,
                                          std::span<const image::Image> all);

/// A picture as it was before to_half().
image::Image to_floats(const image::HalfImage& from);

/// Reads the bakes in FOLDER/bounces-0, FOLDER/bounces-1, ..., as many as there are in a row.
/// Errors: there is none, and the sentence says how to make it; those of files; a bake that does
/// not lie as `lightmaps` do.
Result<BouncedLight> read_bounced(const std::filesystem::path& folder,
                                  const pipeline::LightmapPages& lightmaps);

/// The part of the light, in words.
std::string words_of(const LightShown& light);

}  // namespace luxel::view
