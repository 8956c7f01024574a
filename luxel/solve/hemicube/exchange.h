// Light between elements: direct light once, then passes over the rows.
#pragma once

#include "luxel/light/lights.h"
#include "luxel/solve/hemicube/refill.h"
#include "luxel/solve/hemicube/rows.h"

namespace luxel::hemicube {

/// The way to compute the light of emissive surfaces. Few triangles: exactly, the visible part of
/// each by shadow rays at the same points for all elements, without noise [Heitz18]. Many: by the
/// pixels that see them, as the paper does.
struct Emission {
  bool by_pixels = false;
  light::Lights exact;  ///< lights that the pixels do not take
};
/// Light by pixels where more than 32 triangles shine; punctual lights are exact in any case.
Emission choose_emission(const light::Lights& lights);

struct ExchangeParams {
  int bounces = -1;         ///< passes; < 0: until the light to come is below `tolerance`
  float tolerance = 1e-4f;  ///< root mean square over the elements, relative to the mean
  /// Gets E of all elements after each pass; nothing where nobody does.
  std::function<void(std::span<const Rgb>)> on_bounce{};
};

struct Exchanged {
  std::vector<Rgb> irradiance;  ///< E per element
  int sweeps = 0;
};

/// E = E_0 + F B with B = rho E, by Jacobi iteration: pass n gathers what pass n - 1 reflected
/// [Rodriguez06, General Radiosity Algorithm]; elements inside solids take their neighbours' light
/// after each. `rows` has a row for each element, and `source` its E_0. Starts at `start` when it
/// is not empty and all bounces are wanted, else at E_0. Errors: cancelled, disk.
Result<Exchanged> exchange(const Receivers& receivers, const Rows& rows,
                           std::span<const Rgb> source, const RefillPlan& plan,
                           std::span<const Rgb> start, const ExchangeParams& params,
                           Progress& progress);

/// B = rho E of each element [W/m^2], without emission.
std::vector<Rgb> radiosity(const transport::Elements& elements, std::span<const Rgb> irradiance);

}  // namespace luxel::hemicube
