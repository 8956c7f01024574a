// Where light is computed on a mesh: one element per vertex or per triangle.
#pragma once

#include <span>

#include "luxel/solve/hemicube/mesh.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::hemicube {

enum class ElementKind : uint8_t { vertex, triangle };

/// Neighbours of elements: of a vertex those across an edge, of a triangle those that share an edge
/// and its two vertices.
struct Neighbours {
  std::vector<uint32_t> first;  ///< per element, one extra entry
  std::vector<uint32_t> element;

  std::span<const uint32_t> of(size_t i) const {
    return {element.data() + first[i], element.data() + first[i + 1]};
  }
};

/// The elements of a mesh. Element i is vertex i, or triangle leaves[i].
struct Receivers {
  ElementKind kind = ElementKind::vertex;
  std::vector<uint32_t> leaves;        ///< nodes of the mesh's triangles
  std::vector<uint32_t> leaf_of_node;  ///< index into leaves; kNone for cut nodes
  transport::Elements elements;
  std::vector<float> area_m2;  ///< per element; a vertex has a third of its triangles'
  Neighbours neighbours;

  size_t size() const { return elements.size(); }
};

/// A vertex at the rim of its surface (a crease, an open edge) is looked at from a tenth of its
/// triangles' size inside: there a wall that rises from the rim hides what it must. The paper moves
/// up along the normal instead [Rodriguez06, section 4.5.3], where a wall's foot is lost. Beside a
/// corner light falls like x log x, which linear interpolation from its limit at the rim would
/// underestimate all along the first triangles: a tenth takes half of that away and is wrong by
/// less than it at the rim itself. Where triangles of several sizes meet, each counts by its area,
/// as the vertex's light does in it: a tenth of the smallest would leave the large ones dark.
/// Triangles are looked at from their centroids. A reflectance that varies is averaged over the
/// element.
Receivers make_receivers(const scene::Scene& scene, const Mesh& mesh, ElementKind kind);

/// The centroids of some nodes, without reflectances.
transport::Elements places_of_triangles(const scene::Scene& scene, const Mesh& mesh,
                                        std::span<const uint32_t> leaves);

/// Where a wall stands on a surface that goes on beneath it, the visible part of the surface ends
/// at the wall's foot, as at a rim. Vertices at the foot are looked at from as far off it as
/// vertices at a rim, for the same reason, and not from the wall's own face, where chance decides
/// whether they lie inside of it. Triangles stay.
void step_off_walls(const scene::Scene& scene, const trace::RayTracer& tracer, const Mesh& mesh,
                    Receivers& receivers);

}  // namespace luxel::hemicube
