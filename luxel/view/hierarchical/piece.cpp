#include "luxel/view/hierarchical/piece.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/pipeline/render/draw_hierarchical.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/solve/hierarchical/surface.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// The picture whose exposure is chosen.
constexpr int kExposedWidth = 128, kExposedHeight = 96;

/// Linear, with the same values at the corners.
h::Interpolant linear(const h::Interpolant& r) {
  const Rgb a = h::value_of(r, 0, 0), b = h::value_of(r, 1, 0), c = h::value_of(r, 0, 1);
  return {Rgb{}, {}, b - a, {}, c - a, a};
}

Status take_step(SolverStep step, const SolvedScene& in,
                 const pipeline::HierarchicalSettings& settings, KnownRounds& known,
                 h::Iterated& iterated, Piece& out, Progress& progress) {
  h::RepresentParams represent;
  represent.max_elements = settings.solve.max_elements;
  h::Solution& s = iterated.solution;
  switch (step) {
    case SolverStep::begin: {
      LUXEL_TRY(iterated, h::begin_iterating(in.scene, in.tracer, settings.solve, progress));
      break;
    }
    case SolverStep::links: {
      LUXEL_TRY(out.is_settled,
                h::iterate_once(iterated, in.scene, in.tracer, settings.solve, progress));
      break;
    }
    case SolverStep::interpolants: {
      LUXEL_TRY(const h::Round round, h::represent_once(s, in.scene, in.tracer, settings.mesh,
                                                        represent, known, progress));
      out.is_settled = round.divided == 0;
      break;
    }
    case SolverStep::last: {
      represent.max_rounds = 0;
      LUXEL_TRY(h::LightMesh cut,
                h::represent(s, in.scene, in.tracer, settings.mesh, represent, progress));
      out.cut = std::make_shared<const h::LightMesh>(std::move(cut));
      out.is_settled = true;
      break;
    }
  }
  return {};
}

}  // namespace

Result<Piece> stepped(const Piece& from, SolverStep step, const SolvedScene& in,
                      const pipeline::HierarchicalSettings& settings, KnownRounds& known,
                      Progress& progress) {
  LUXEL_CHECK(step == SolverStep::begin || from.iterated);
  // Rounds look at one light; every other step makes another.
  if (step != SolverStep::interpolants) known = {};
  Piece out;
  out.number = from.number + 1;
  auto iterated = step == SolverStep::begin ? std::make_shared<h::Iterated>()
                                            : std::make_shared<h::Iterated>(*from.iterated);
  LUXEL_TRY_STATUS(take_step(step, in, settings, known, *iterated, out, progress));
  LUXEL_TRY(h::LightMesh flat,
            h::make_flat_mesh(iterated->solution, in.scene, in.tracer, progress));
  out.flat = std::make_shared<const h::LightMesh>(std::move(flat));
  const auto links = [&](bool is_whole) {
    return std::make_shared<const std::vector<pipeline::StrongLink>>(
        pipeline::strong_links(iterated->solution, in.tracer, {is_whole, !is_whole, kMostLinks}));
  };
  out.whole_links = links(true), out.partial_links = links(false);
  out.iterated = std::move(iterated);
  return out;
}

const h::LightMesh* mesh_of(const Piece& piece, LightKind kind) {
  switch (kind) {
    case LightKind::flat:
      return piece.flat.get();
    case LightKind::gouraud:
      return piece.whole.get();
    default:
      return piece.cut.get();
  }
}

display::QuadraticMesh drawn_mesh(const Piece& piece, const h::LightMesh& mesh, LightKind kind,
                                  const scene::Scene& scene) {
  display::QuadraticMesh out = pipeline::quadratic_mesh(scene, piece.solution(), mesh);
  if (kind == LightKind::gouraud || kind == LightKind::gouraud_disc)
    for (h::Interpolant& r : out.irradiance) r = linear(r);
  return out;
}

std::vector<uint32_t> faces_of(const h::LightMesh& mesh) {
  std::vector<uint32_t> out;
  for (const h::LightTriangle& t : mesh.triangles) out.push_back(t.face);
  return out;
}

float readable_exposure(const Piece& piece, const ReadScene& read) {
  const h::Solution& s = piece.solution();
  display::DrawParams params;
  params.width = kExposedWidth, params.height = kExposedHeight, params.samples_per_axis = 1;
  const auto irradiance = [&](const scene::SurfacePoint& p) -> Rgb {
    const h::FacePoint place = h::face_point_of(read.scene, s.faces, p);
    if (place.face == h::kNone) return {};
    return s.light.elements[h::leaf_at(s.tree, s.faces, place.face, place.position)].irradiance;
  };
  Progress own;  // its stage is not of the step
  const auto picture =
      display::draw(read.scene, *read.tracer, read.first.camera, irradiance, params, own);
  return picture ? display::readable_exposure(*picture) : 1;
}

int depth_of(const h::Tree& tree) {
  std::vector<int> depth(tree.elements.size());
  int deepest = 0;
  for (size_t i = 0; i < depth.size(); ++i) {
    const h::Element& e = tree.elements[i];
    if (!e.is_leaf()) std::fill_n(depth.begin() + std::ptrdiff_t(e.child), 4, depth[i] + 1);
    deepest = std::max(deepest, depth[i]);
  }
  return deepest;
}

}  // namespace luxel::view
