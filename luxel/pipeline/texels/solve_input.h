// The input of every solver of the pipeline besides a light::TexelScene, and its result.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/bytes_per_entry.h"
#include "luxel/base/part_store.h"
#include "luxel/base/team.h"
#include "luxel/light/chosen_elements.h"
#include "luxel/light/light_estimate.h"
#include "luxel/light/light_layers.h"
#include "luxel/light/texel_scene.h"
#include "luxel/scene/scene.h"
#include "luxel/solve/hemicube/observer.h"

namespace luxel::gather {
class RayDevice;
}
namespace luxel::hemicube {
class LookDevice;
}
namespace luxel::reference {
class PathDevice;
}

namespace luxel::pipeline {

class BakeCache;

/// A graphics device. What the bake's solver asks is not null.
struct BakeDevice {
  gather::RayDevice* rays = nullptr;       ///< for gather
  hemicube::LookDevice* look = nullptr;    ///< for hemicube
  reference::PathDevice* paths = nullptr;  ///< for reference
  std::string name;                        ///< its name in bake.json
  /// Where the device cannot have the bake, or fails, the processor has it, with a warning.
  bool is_optional = false;
};

/// Objects that outlive a solver; null where there is none.
struct SolveStores {
  PartStore* parts = nullptr;  ///< where its finished parts are kept and found
  BakeCache* cache = nullptr;  ///< the bake that it builds on, and its place for later bakes
  const BakeDevice* device = nullptr;
  Team* team = nullptr;  ///< whose members share the work out, of a solver with `teams`
};

/// Observers of a solver; nothing where nobody watches.
struct SolveObserver {
  light::OnLightEstimate on_estimate{};  ///< gets light as it grows, of a solver with `errors`
  /// With on_estimate: GatherObserver::guess and GatherObserver::is_watched.
  std::function<std::vector<Rgb>(std::span<const Rgb> direct)> guess{};
  std::function<bool(size_t element)> is_watched{};
  light::OnBounce on_bounce{};  ///< GatherObserver::on_bounce
  /// Watches hemicube; null: nobody does.
  const hemicube::Observer* hemicube = nullptr;
  /// Called, or not, when the solver looks at no place of an element any more: they take memory.
  std::function<void()> on_traced{};
};

/// Light per vertex of a solver's own mesh.
struct VertexLit {
  scene::Scene scene;   ///< one mesh per instance, in the world; materials unlit
  float intensity = 1;  ///< colors * intensity = E [W/m^2], times the scene's own vertex colours
};

/// The result of every solver.
struct TexelLight {
  std::vector<Rgb> irradiance;  ///< E per texel of the map [W/m^2]
  /// Estimated variance of its luminance per texel, the direct part aside; empty: light without
  /// noise, or noise that nobody knows.
  std::vector<float> variance;
  /// The part of the irradiance that comes straight from lights, and its variance; empty: not
  /// apart.
  std::vector<Rgb> direct;
  std::vector<float> direct_variance;
  /// Where the solver knows it, the standard error of each texel's luminance, relative to itself
  /// or, where it is darker, to a tenth of the mean; empty: it does not. Hidden texels have none.
  std::vector<float> errors;
  /// With errors: 95 of 100 texels err by less than this (gather::error_p95).
  float error_p95 = 0;
  /// With --layers: which there are, and E of each per texel; they add up to the irradiance.
  std::vector<light::LightLayer> layers;
  std::vector<std::vector<Rgb>> layer_irradiance;
  std::vector<uint16_t> samples;     ///< with errors: indirect rays per texel
  uint64_t rays = 0;                 ///< that were traced
  uint64_t rays_kept = 0;            ///< that an earlier bake had traced
  uint64_t supersampled_texels = 0;  ///< direct light is a mean over their points
  int sweeps = 0;
  double relative_error = 0;  ///< estimated, root mean square over the mean
  /// Where the solver gives some, the light of some texels anew, and the part of relative_error
  /// that answers have as well, so that they do not show it.
  light::Answers answers;
  double relative_unseen = 0;
  /// With answers: relative_error of the light that the denoiser has left.
  std::optional<double> delivered_error;
  std::vector<uint8_t> hidden;     ///< per texel: 1 inside a solid, where E means nothing
  uint64_t suspicious_texels = 0;  ///< more than half of the rays met backs of one-sided surfaces
  uint64_t scratch_bytes = 0;      ///< in temporary files, mapped ones too
  uint64_t elements = 0;           ///< of the solver's own mesh, when it has one
  std::string device;              ///< BakeDevice::name, if it took part
  std::vector<std::string> warnings;
  std::optional<VertexLit> vertex_lit;  ///< with --vertex-colors
};
/// Those of its arrays that a bake gives back before files are made, where its texels lie in files
/// (mapped_memory_of()) and nobody watches it.
inline constexpr uint64_t kPartsBytesPerElement =
    bytes_per_entry(&TexelLight::variance, &TexelLight::direct, &TexelLight::direct_variance);
/// Bytes of TexelLight per element, layers aside, where a solver fills all of it.
inline constexpr uint64_t kLightBytesPerElement = bytes_per_entry(
    &TexelLight::irradiance, &TexelLight::variance, &TexelLight::direct,
    &TexelLight::direct_variance, &TexelLight::errors, &TexelLight::samples, &TexelLight::hidden);

}  // namespace luxel::pipeline
