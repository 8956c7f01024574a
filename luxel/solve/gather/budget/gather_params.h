// What gather is asked for: how many rays, to which error or within which time, and where it keeps
// what.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "luxel/base/part_store.h"
#include "luxel/light/light_estimate.h"
#include "luxel/light/light_layers.h"
#include "luxel/solve/gather/reuse/earlier.h"

namespace luxel::gather {

/// What gather is asked for: rays, bounces, and where its parts are kept.
struct GatherParams {
  int samples = 256;  ///< indirect rays per element; with max_error or seconds, of the first round
  /// > 0: rounds of more samples until 95 % of elements have a smaller relative error (adaptive.h).
  float max_error = 0;
  /// > 0: rounds of more samples while they, and the bounces, end within so many seconds from the
  /// call. The first round and the first direct light are not cut short. Depends on the machine.
  double seconds = 0;
  int max_samples = 16384;  ///< with max_error or seconds, per element
  int direct_samples = 64;  ///< shadow rays per element towards emissive surfaces
  int supersample = 1;      ///< points per element where direct light varies; 1: none
  int bounces = -1;         ///< < 0: all
  float tolerance = 1e-4f;  ///< see BounceParams
  uint64_t seed = 1;
  const light::LightLayers* layers = nullptr;  ///< null: light is not told apart
  uint64_t hit_memory_bytes = UINT64_MAX;
  std::filesystem::path scratch_folder = ".";
  PartStore* parts = nullptr;  ///< where finished parts are kept and found; null: nowhere
  PartStore* keep = nullptr;   ///< where rays are kept for later bakes of the scene; null: nowhere
  Earlier* earlier = nullptr;  ///< is used up; its rounds come first; null: nothing is known
  /// Gets the light as it grows: direct light with an ambient term [Cohen88], then that of a few
  /// rays, of twice as many, and so on, the last being what gather() returns. `samples` come in
  /// rounds then, and the result is that without it up to rounding (adaptive_test.cpp).
  light::OnLightEstimate on_estimate{};
  /// Called when every ray is traced: drop_places() may be called on the elements then.
  std::function<void()> on_traced{};
};

}  // namespace luxel::gather
