// Data of a scene by which its light can move later: the content of an .lxr file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "luxel/base/vec_double.h"
#include "luxel/scene/scene.h"
#include "luxel/solve/matrix/bc1.h"
#include "luxel/solve/matrix/bounces.h"
#include "luxel/solve/matrix/dense.h"
#include "luxel/solve/matrix/glow.h"
#include "luxel/solve/matrix/hierarchical.h"
#include "luxel/solve/matrix/lowrank.h"
#include "luxel/solve/matrix/patches.h"
#include "luxel/solve/matrix/transfer.h"

namespace luxel::matrix {

/// F by its entries; bounces are iterated.
struct DenseCodec {
  Dense matrix;
  CoarseScene coarse;  ///< for all bounces
  int32_t sweeps = 2;  ///< of all_bounces
};

/// F as an H^2-matrix; bounces are iterated.
struct HierarchicalCodec {
  Hierarchical matrix;
  CoarseScene coarse;  ///< for all bounces
  int32_t sweeps = 2;  ///< of all_bounces
};

/// All bounces, or those that were asked for, in one product [Shcherbakov17].
struct Bc1Codec {
  Bc1 matrix;
};

/// F by its leading eigenvectors; bounces are one product.
struct LowRankCodec {
  LowRank matrix;
};

/// One codec's matrix: irradiance from what patches send. A file knows codecs by their place here.
using Codec = std::variant<HierarchicalCodec, DenseCodec, Bc1Codec, LowRankCodec>;

/// Places whose light is wanted.
struct Target {
  /// Patches only, texels of a lightmap, or vertices of the scene's meshes.
  enum class Kind : uint32_t { none, texels, vertices };
  Kind kind = Kind::none;
  uint32_t width = 0, height = 0;              ///< of the map, for texels
  std::vector<std::array<uint16_t, 2>> texel;  ///< per place, for texels: x, y in the map
  std::vector<Vec3> position;                  ///< per place [m], as in transport::Elements
  std::vector<Vec3> normal, geometric_normal;  ///< per place: for cosines; of the surface
  Transfer transfer;                           ///< from patches to places
};

/// Triangles that throw shadows: both sides of all of them block.
struct Occluders {
  std::vector<Vec3> position;
  std::vector<std::array<uint32_t, 3>> triangle;
};

/// All that an .lxr file holds: docs/format/lxr.md.
struct RelightData {
  // Per patch, in the order of the codec's cluster tree.
  std::vector<Vec3> position, normal;  ///< the middle, as probes lie; unit, front side
  std::vector<float> area_m2;
  std::vector<Rgb> reflectance;
  std::vector<Rgb> emission;          ///< B_e = pi L as baked [W/m^2]
  std::vector<float> sky;             ///< the share of its hemisphere that is background
  std::vector<uint32_t> material;     ///< of `material_name`
  std::vector<uint32_t> first_probe;  ///< per patch, one extra entry: its part of `probe`
  std::vector<PatchPoint> probe;      ///< where its direct light is taken

  std::vector<std::string> material_name;
  std::vector<scene::PunctualLight> lights;  ///< as baked
  Rgb background{};                          ///< as baked [W/(sr m^2)]
  int32_t bounces = -1;                      ///< reflections to count; < 0: all
  Glow glow;  ///< light straight from surfaces; nothing kept: it is the codec's
  /// Relative: what 95 of 100 lights lose less than by the codec, and what was held to
  /// RelightParams::max_error.
  double codec_error = 0, usual_codec_error = 0;
  /// Root mean square error of indirect light at points of the surfaces over its mean, by paths: of
  /// the lights as baked, and of point lights in the open. 0: not measured.
  double baked_error = 0, lamp_error = 0;
  Codec codec;
  Target target;
  Occluders occluders;
  /// The scene with its lightmap coordinates as binary glTF, for players; may be empty.
  std::vector<std::byte> scene_glb;
  DVec3 origin{};  ///< scene::Scene::origin of all places here, those of `scene_glb` too

  /// The number of patches.
  size_t size() const { return area_m2.size(); }
};

/// One mesh of one material.
scene::Scene scene_of(const Occluders& occluders);

/// Area-weighted mean of B_e per material.
std::vector<Rgb> mean_emission_of(const RelightData& data);

}  // namespace luxel::matrix
