// Hemicube radiosity on the scene's own mesh, per vertex or per triangle. [Cohen85; Rodriguez06]
#pragma once

#include "luxel/light/lights.h"
#include "luxel/solve/hemicube/field.h"
#include "luxel/solve/hemicube/observer.h"
#include "luxel/solve/hemicube/rows.h"

namespace luxel::hemicube {

/// Settings of the hemicube solver.
struct HemicubeParams {
  ElementKind elements = ElementKind::vertex;
  int resolution = 64;  ///< pixels along an edge of the hemicube's top, even, 2 to kMaxResolution
  /// Triangles start about this small [m]; 0: so that there are about max_elements of them, or a
  /// third of that when more are to be cut where the light varies.
  float element_size_m = 0;
  /// 0: 20,000, or half as many again as the scene's own when that is more.
  size_t max_elements = 0;
  /// Triangles are cut while linear interpolation over them errs by more than this part of the
  /// light there. 0: none is.
  float max_error = 0.01f;
  int direct_samples = 256;  ///< shadow rays per element towards emissive surfaces
  int bounces = -1;          ///< < 0: until the light to come is below `tolerance`
  float tolerance = 1e-4f;   ///< root mean square over the elements, relative to the mean
  uint64_t seed = 1;
  bool smooth = false;  ///< triangle: interpolate between their middles, too
  uint64_t row_memory_bytes = UINT64_MAX;
  std::filesystem::path scratch_folder = ".";
  LookDevice* device = nullptr;  ///< what looks through hemicubes; null: the processor
  Team* team = nullptr;          ///< whose members share hemicubes and their rows out; null: none
};

inline constexpr int kMaxResolution = 2048;

/// Memory for a hemicube's pixels, shared and of all threads, before anything is seen [bytes].
uint64_t bytes_of_hemicube(int resolution, int threads);

/// The light of a scene on a mesh of its own.
struct Solution {
  Field field;
  std::vector<uint8_t> hidden;    ///< per element of the field: 1 inside a solid
  std::vector<uint8_t> enclosed;  ///< per element: 1 where is_enclosed
  std::vector<uint8_t> covered;   ///< per element: 1 where transport::open_share is below 1
  float element_size_m = 0;       ///< mean leg of the first mesh's triangles
  uint64_t rays = 0;
  int sweeps = 0;  ///< of the last exchange
  uint64_t row_bytes = 0, row_bytes_in_file = 0;
  /// Estimated root mean square error of the interpolation over the mean irradiance.
  double relative_error = 0;
  LookSeconds seconds;
};

/// Cuts the scene's triangles, looks from each element, exchanges light until it settles, then cuts
/// on where it varies, and lets all elements of the finished mesh look and exchange light anew.
/// All members of a team get the whole solution, and none has an observer of views. Errors:
/// settings, cancelled, disk full; those of params.device; another member of the team gives up.
Result<Solution> solve(const scene::Scene& scene, const light::Lights& lights,
                       const trace::RayTracer& tracer, const HemicubeParams& params,
                       Progress& progress, const Observer& observer = {});

}  // namespace luxel::hemicube
