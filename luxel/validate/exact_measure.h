// Measures a solver's error against an exact answer.
#pragma once

#include <string_view>
#include <vector>

#include "luxel/validate/exact_cases.h"
#include "luxel/validate/prepared.h"

namespace luxel::validate {

struct Measured {
  double exact = 0;           ///< mean of E over the part's surface
  double mean = 0;            ///< of the solver's E over the same places
  double standard_error = 0;  ///< of `mean`, by the solver's own account; 0 where it gives none
  /// Root mean square of the relative error at the texels' samples; pointwise parts only. Where E
  /// is below a tenth of its mean, relative to that tenth.
  double texel_rms = 0;
};

struct MeasureEffort {
  int rays = 1024, shadow_rays = 256;  ///< gather's, per texel
  int paths = 64;                      ///< per texel
  int64_t elements = 5000;             ///< hemicube's, at most; scenes that have more keep theirs
  int hemicube = 64;                   ///< pixels along an edge; 16 where elements abound
  int64_t patches = 4096;              ///< of the matrix
  size_t lightmap_points = 400000;     ///< where a lightmap is read for its mean
  size_t path_points = 50000;          ///< where paths begin for their mean, over the whole scene
  int paths_per_point = 32;
};

/// True where a solver can be asked for a case by now. The hierarchical solver cannot for the
/// spheres: it links their 10,000 facets and more by the million, in minutes.
bool is_ready_for(std::string_view solver, const ExactCase& c);

/// One for each part of the case. `p` is the case's scene at its resolution. A solver's mean is
/// read from its lightmap; only the path tracer, whose mean must be exact, begins its paths at
/// places of its own, so that no texel blurs it and its printed standard error is the whole error.
Result<std::vector<Measured>> measure(const Prepared& p, const ExactCase& c,
                                      std::string_view solver, const MeasureEffort& effort,
                                      Progress& progress);

}  // namespace luxel::validate
