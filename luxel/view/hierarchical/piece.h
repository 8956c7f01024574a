// A hierarchical solution between two steps, and what was made of it to be looked at. [Hardt96,
// appendix B.3]
#pragma once

#include <memory>
#include <vector>

#include "luxel/display/quadratic_view.h"
#include "luxel/pipeline/render/overlays.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/solve/hierarchical/discontinuities.h"
#include "luxel/view/read_scene.h"

namespace luxel::view {

/// Light that surfaces show of a solution, from coarse to exact. The names are those of `luxel
/// render`.
enum class LightKind : uint8_t {
  flat,          ///< a value for each element
  gouraud,       ///< exact light at elements' corners, linear between
  gouraud_disc,  ///< and cut along discontinuities
  interpolant,   ///< quadratic over the triangles of the light mesh
  exact,         ///< of each pixel
};

/// So many links of a piece can be drawn of either kind.
inline constexpr size_t kMostLinks = 5000;

/// A solution does not change once it is handed over, nor does what is made of it.
struct Piece {
  std::shared_ptr<const hierarchical::Iterated> iterated;
  std::shared_ptr<const hierarchical::LightMesh> flat;   ///< make_flat_mesh()
  std::shared_ptr<const hierarchical::LightMesh> whole;  ///< without discontinuities; may be null
  std::shared_ptr<const hierarchical::LightMesh> cut;    ///< the light mesh; may be null
  /// All there are, whatever their weight; may be null.
  std::shared_ptr<const std::vector<hierarchical::Discontinuity>> discontinuities;
  /// Errors of the interpolants of `cut` [W/m^2]; may be null.
  std::shared_ptr<const std::vector<float>> error;
  /// The strongest between which nothing stands, and something.
  std::shared_ptr<const std::vector<pipeline::StrongLink>> whole_links, partial_links;
  uint64_t number = 0;      ///< another one for each solution
  bool is_settled = false;  ///< the last step found nothing to divide

  const hierarchical::Solution& solution() const { return iterated->solution; }
};

/// Scene and tracer of what is solved.
struct SolvedScene {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
};

/// One step of the solver. Those of represent() look at what interpolants show.
enum class SolverStep : uint8_t {
  begin,         ///< everything linked to everything, by a guess of the light
  links,         ///< iterate_once()
  interpolants,  ///< represent_once()
  last,          ///< represent() without dividing: the solution learns from its light mesh
};

/// Findings of the rounds of represent() by one light.
using KnownRounds = hierarchical::Known;

/// A step from a piece, which may be empty for `begin`. The piece has `flat`, and `cut` after
/// `last`. Errors: cancelled; settings that cannot be.
Result<Piece> stepped(const Piece& from, SolverStep step, const SolvedScene& scene,
                      const pipeline::HierarchicalSettings& settings, KnownRounds& known,
                      Progress& progress);

/// The mesh that a kind of light is drawn by; null where it is not made yet.
const hierarchical::LightMesh* mesh_of(const Piece& piece, LightKind kind);

/// Triangles as they are drawn, by `mesh` of the piece: linear from corner to corner where the kind
/// is.
display::QuadraticMesh drawn_mesh(const Piece& piece, const hierarchical::LightMesh& mesh,
                                  LightKind kind, const scene::Scene& scene);
/// The face of each of its triangles.
std::vector<uint32_t> faces_of(const hierarchical::LightMesh& mesh);

/// At which a flat picture of the first view is readable.
float readable_exposure(const Piece& piece, const ReadScene& read);

/// Depth of the deepest element below its root, which is at 0.
int depth_of(const hierarchical::Tree& tree);

}  // namespace luxel::view
