// From a scene to what an .lxr file holds.
#pragma once

#include <span>

#include "luxel/solve/matrix/matrix.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

/// Forms of the matrix in an .lxr file; docs/method/relight.md compares them.
enum class CodecKind : uint8_t { hierarchical, lowrank, bc1, dense32, dense16 };

/// A matrix of all pairs takes 4 to 12 bytes each, and several of them while it is made.
inline constexpr size_t kMaxDensePatches = 20000;
/// True: making the codec holds a number for every pair of patches.
constexpr bool looks_at_all_pairs(CodecKind kind) {
  return kind != CodecKind::hierarchical && kind != CodecKind::lowrank;
}

/// Clusters of the coarse scene, before those are split whose patches see different things. Linear
/// functions over fewer clusters were tried: they do no better for as many numbers.
inline constexpr size_t kCoarseClusters = 300;

/// Settings by which an .lxr file is made.
struct RelightParams {
  PatchParams patches;
  FactorParams factors;
  CodecKind codec = CodecKind::hierarchical;
  /// Error that a codec may have: relative root mean square of the indirect light over all patches
  /// (by area), by usual_error().
  float max_error = 0.01f;
  int bounces = -1;  ///< products; < 0: all
};

/// Everything but RelightData::scene_glb. `target` is where light is wanted, its transfer still
/// empty. Members of a team share the rays of form factors out; all but the first end with
/// ErrorCode::parts_missing then, for the rest is the first one's. Errors: no surface, a light with
/// a profile, cancelled, a codec that cannot hold so many patches, another member gives up.
Result<RelightData> make_relight_data(const scene::Scene& scene, const trace::RayTracer& tracer,
                                      Target target, const RelightParams& params,
                                      Progress& progress, Team* team = nullptr);

}  // namespace luxel::matrix
