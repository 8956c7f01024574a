#include "luxel/solve/hierarchical/light_mesh.h"

#include <algorithm>
#include <map>

#include "luxel/base/parallel.h"
#include "luxel/solve/hierarchical/outlines.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/solve/hierarchical/triangulate.h"

namespace luxel::hierarchical {
namespace {

/// Corners nearer than this part of a leaf's size are one.
constexpr double kNearCorners = 1e-4;
/// Where another face touches a sample point, it is moved by this part of the way to its triangle's
/// middle: irradiance there is the limit from inside [Hardt96, section 6.3].
constexpr double kNudge = 1e-3;

/// Discontinuities are kept down to this part of the least weight: refinement and feedback may make
/// their sources brighter by the time of the last mesh, but hardly twice as bright.
constexpr double kWeaker = 0.5;

/// A face while it is meshed.
struct FaceMeshing {
  FacePlane plane;
  std::vector<size_t> leaves;               ///< elements
  std::vector<std::vector<DVec2>> outline;  ///< per leaf
  std::vector<ActiveLine> lines;
  std::vector<std::vector<Segment2>> pieces;  ///< per leaf, clipped to it
};

void add_leaves(const Tree& tree, size_t element, std::vector<size_t>& out) {
  if (tree.elements[element].is_leaf()) {
    out.push_back(element);
    return;
  }
  for (uint32_t c = tree.elements[element].child, end = c + 4; c < end; ++c)
    add_leaves(tree, c, out);
}

struct Maker {
  const Solution& s;
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const MeshParams& params;
  double slack_m;  ///< corners nearer than this are one
};

double slack_of(const Solution& s) {
  return std::max(4 * s.faces.slack_m, 1e-7 * double(s.diagonal_m));
}

/// `found`: of the face, or nothing yet.
FaceMeshing prepare_face(const Maker& m, uint32_t face, const DiscontinuityLimits& limits,
                         std::optional<std::vector<Discontinuity>>& found) {
  // Its leaves, in its plane.
  FaceMeshing w;
  w.plane = plane_coordinates(m.s.faces.faces[face]);
  for (uint32_t r = m.s.tree.first_root[face]; r < m.s.tree.first_root[face + 1]; ++r)
    add_leaves(m.s.tree, r, w.leaves);
  for (const size_t leaf : w.leaves) {
    w.outline.emplace_back();
    for (const DVec3& p : m.s.tree.elements[leaf].polygon())
      w.outline.back().push_back(w.plane.to_plane(p));
  }
  // Lines by the light there is now.
  if (m.params.discontinuities) {
    if (!found)
      found = find_discontinuities(m.s, m.scene, m.tracer, face, m.params.discontinuity.ranking,
                                   {kWeaker * limits.weight, limits.light});
    std::vector<double> weight;
    for (const Discontinuity& d : *found) weight.push_back(weight_of(d, m.s, m.scene));
    w.lines = choose_active(*found, weight, limits.weight, w.plane, w.outline,
                            m.params.discontinuity.max_per_leaf, m.slack_m);
  }
  // The pieces of the lines that cross each leaf.
  for (const auto& outline : w.outline) {
    w.pieces.emplace_back();
    for (const ActiveLine& line : w.lines)
      if (Segment2 inside = line.piece; clip_to(outline, m.slack_m, inside))
        w.pieces.back().push_back(inside);
  }
  return w;
}

/// Calls visit(point) for corners of leaves and ends of lines.
template <class Visit>
void for_points(const Maker& m, const FaceMeshing& w, const Visit& visit) {
  for (size_t k = 0; k < w.leaves.size(); ++k) {
    for (const DVec3& p : m.s.tree.elements[w.leaves[k]].polygon()) visit(p);
    for (const Segment2& piece : w.pieces[k])
      visit(w.plane.from_plane(piece.a)), visit(w.plane.from_plane(piece.b));
  }
}

/// A leaf's corners with all that its neighbours have on its edges.
std::vector<DVec2> full_outline(const Maker& m, const FaceMeshing& w, uint32_t face, size_t leaf,
                                const EdgePoints& of_face, const EdgePoints& of_outlines) {
  const Face& f = m.s.faces.faces[face];
  const PolygonView polygon = m.s.tree.elements[leaf].polygon();
  std::vector<DVec2> out;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec3 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    out.push_back(w.plane.to_plane(a));
    const bool is_outer = depth_inside(f.corners, f.plane.normal, (a + b) * 0.5) <= m.slack_m;
    EdgePoints both(m.slack_m);
    for (const DVec3& p : of_face.along(a, b)) both.add(p);
    if (is_outer)
      for (const DVec3& p : of_outlines.along(a, b)) both.add(p);
    both.sort();
    for (const DVec3& p : both.along(a, b)) {
      const double t = dot(p - a, b - a) / dot(b - a, b - a);  // on the edge itself
      out.push_back(w.plane.to_plane(a + (b - a) * t));
    }
  }
  return out;
}

bool lies_on(const Segment2& s, DVec2 a, DVec2 b, double slack_m) {
  const DVec2 d = s.b - s.a;
  const double size = std::sqrt(dot(d, d));
  for (const DVec2 p : {a, b}) {
    const double t = dot(p - s.a, d) / size;
    if (std::abs(cross(d, p - s.a)) > slack_m * size || t < -slack_m || t > size + slack_m)
      return false;
  }
  return true;
}

/// Triangulates the leaves of a face into `mesh`.
void add_face(const Maker& m, const FaceMeshing& w, uint32_t face, const EdgePoints& of_outlines,
              Welder& welder, std::vector<std::vector<LightTriangle>>& of_element,
              LightMesh& mesh) {
  // Corners that leaves may share with their neighbours of the same face.
  EdgePoints of_face(m.slack_m);
  for_points(m, w, [&](DVec3 p) { of_face.add(p); });
  of_face.sort();
  for (size_t k = 0; k < w.leaves.size(); ++k) {
    const double least_m =
        std::max(2 * m.slack_m, kNearCorners * std::sqrt(m.s.tree.elements[w.leaves[k]].area_m2));
    const Triangulation t = triangulate(full_outline(m, w, face, w.leaves[k], of_face, of_outlines),
                                        w.pieces[k], least_m);
    // The triangles, with numbers for their corners; none that welding has closed.
    std::vector<uint32_t> vertex;
    for (const DVec2 p : t.points)
      vertex.push_back(welder.index_of(w.plane.from_plane(p), mesh.vertices));
    for (const auto& corners : t.triangles) {
      LightTriangle out;
      out.face = face, out.leaf = uint32_t(w.leaves[k]);
      for (size_t c = 0; c < 3; ++c) {
        out.vertex[c] = vertex[corners[c]];
        for (const Segment2& piece : w.pieces[k])
          out.edge_is_line[c] |=
              lies_on(piece, t.points[corners[c]], t.points[corners[(c + 1) % 3]], 2 * least_m);
      }
      if (out.vertex[0] != out.vertex[1] && out.vertex[1] != out.vertex[2] &&
          out.vertex[2] != out.vertex[0])
        of_element[w.leaves[k]].push_back(out);
    }
  }
  mesh.lines += w.lines.size();
}

Status triangulate_all(const Maker& m, Known& known, LightMesh& mesh, Progress& progress) {
  // Leaves and lines of all faces.
  const size_t faces = m.s.faces.size();
  std::vector<FaceMeshing> meshing(faces);
  const DiscontinuityLimits limits = limits_of(m.s, m.params.discontinuity);
  known.of_face.resize(faces);
  progress.begin("discontinuities", faces);
  parallel_for(faces, 1, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end && !progress.cancelled(); ++f)
      meshing[f] = prepare_face(m, uint32_t(f), limits, known.of_face[f]);
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  // Points on the outlines of faces, which neighbouring faces must have, too.
  progress.begin("triangulate", faces);
  EdgePoints of_outlines(m.slack_m);
  for (uint32_t f = 0; f < faces; ++f) {
    const Face& face = m.s.faces.faces[f];
    for_points(m, meshing[f], [&](DVec3 p) {
      if (depth_inside(face.corners, face.plane.normal, p) <= m.slack_m) of_outlines.add(p);
    });
  }
  of_outlines.sort();
  // Triangles face by face, then in the order of elements.
  std::vector<std::vector<LightTriangle>> of_element(m.s.tree.elements.size());
  std::map<uint32_t, Welder> of_instance;
  for (uint32_t f = 0; f < faces; ++f) {
    LUXEL_TRY_STATUS(stopped(progress));
    // Faces of a curved surface share their vertices, and with them the light there.
    const Face& face = m.s.faces.faces[f];
    Welder own(m.slack_m);
    Welder& welder =
        face.curved ? of_instance.try_emplace(face.instance, m.slack_m).first->second : own;
    add_face(m, meshing[f], f, of_outlines, welder, of_element, mesh);
    progress.advance(1);
  }
  for (const auto& triangles : of_element) {
    mesh.first_of_element.push_back(uint32_t(mesh.triangles.size()));
    mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
  }
  mesh.first_of_element.push_back(uint32_t(mesh.triangles.size()));
  return {};
}

/// Where irradiance is asked for: each place once for the light that is the same on both sides of
/// its edge, and for each triangle's side of it for that of sharp lights, whose shadows end there.
struct Samples {
  std::vector<Receiver> receivers;
  std::vector<std::array<uint32_t, 6>> of_triangle;
  std::vector<Receiver> inside;  ///< six per triangle; none in scenes without punctual lights
};

/// Another face meets this one there at an angle; neighbours on a curved surface do not.
bool is_touched(const Maker& m, uint32_t face, DVec3 p) {
  static thread_local std::vector<uint32_t> found;
  find_touching(m.s.blockers, p, 2 * m.slack_m, found);
  const Face& own = m.s.faces.faces[face];
  return std::any_of(found.begin(), found.end(), [&](uint32_t f) {
    const Face& other = m.s.faces.faces[f];
    if (f == face || (own.curved && other.curved && own.instance == other.instance)) return false;
    return length(cross(other.plane.normal, own.plane.normal)) > 1e-6;
  });
}

Samples collect_samples(const Maker& m, const LightMesh& mesh) {
  Samples out;
  constexpr uint32_t kTouched = kNone - 1;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> known;  // (vertex, vertex): itself or an edge
  for (const LightTriangle& t : mesh.triangles) {
    const std::array<DVec3, 3> c{mesh.vertices[t.vertex[0]], mesh.vertices[t.vertex[1]],
                                 mesh.vertices[t.vertex[2]]};
    const DVec3 middle = middle_of(mesh, t);
    auto& samples = out.of_triangle.emplace_back();
    // In the order of interpolant_of: corner, middle of its edge, next corner, ...
    constexpr std::array<std::pair<int, int>, 6> kPlaces{
        {{0, 0}, {0, 1}, {1, 1}, {1, 2}, {2, 2}, {2, 0}}};
    for (size_t k = 0; k < 6; ++k) {
      const auto [i, j] = kPlaces[k];
      const uint32_t a = t.vertex[size_t(i)], b = t.vertex[size_t(j)];
      const DVec3 p = (c[size_t(i)] + c[size_t(j)]) * 0.5;
      const auto inside = [&] {
        return receiver_at(m.s, m.scene, m.tracer, t.face, p + (middle - p) * kNudge);
      };
      if (!m.scene.lights.empty()) out.inside.push_back(inside());
      const auto [entry, is_new] = known.try_emplace(std::minmax(a, b), kTouched);
      if (is_new && !is_touched(m, t.face, p)) {
        entry->second = uint32_t(out.receivers.size());
        out.receivers.push_back(receiver_at(m.s, m.scene, m.tracer, t.face, p));
      }
      samples[k] = entry->second;
      if (samples[k] != kTouched) continue;
      samples[k] = uint32_t(out.receivers.size());
      out.receivers.push_back(inside());
    }
  }
  return out;
}

}  // namespace

Interpolant interpolant_of(const std::array<Rgb, 6>& r) {
  return {2 * r[0] - 4 * r[1] + 2 * r[2], 4 * r[0] - 4 * r[1] + 4 * r[3] - 4 * r[5],
          -3 * r[0] + 4 * r[1] - r[2],    2 * r[0] + 2 * r[4] - 4 * r[5],
          -3 * r[0] - r[4] + 4 * r[5],    r[0]};
}

Result<LightMesh> make_light_mesh(const Solution& s, const scene::Scene& scene,
                                  const trace::RayTracer& tracer, const MeshParams& params,
                                  Progress& progress) {
  Known none;
  return make_light_mesh(s, scene, tracer, params, none, progress);
}

Result<LightMesh> make_light_mesh(const Solution& s, const scene::Scene& scene,
                                  const trace::RayTracer& tracer, const MeshParams& params,
                                  Known& known, Progress& progress) {
  const Maker m{s, scene, tracer, params, slack_of(s)};
  // Triangles, and the points at which their light is asked for.
  LightMesh mesh;
  LUXEL_TRY_STATUS(triangulate_all(m, known, mesh, progress));
  const Samples samples = collect_samples(m, mesh);
  LUXEL_TRY(const std::vector<Rgb> e,
            continuous_irradiance_at(s, scene, tracer, samples.receivers, params.point, known.light,
                                     progress));
  LUXEL_TRY(const std::vector<Rgb> sharp,
            sharp_irradiance_at(scene, tracer, samples.inside, progress));
  // The quadratic function through six of them.
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Rgb, 6> value;
    for (size_t k = 0; k < 6; ++k) {
      value[k] = e[samples.of_triangle[t][k]];
      if (!sharp.empty()) value[k] += sharp[6 * t + k];
    }
    mesh.interpolant.push_back(interpolant_of(value));
  }
  mesh.samples = known.light.at.size();
  return mesh;
}

Result<LightMesh> make_flat_mesh(const Solution& s, const scene::Scene& scene,
                                 const trace::RayTracer& tracer, Progress& progress) {
  MeshParams params;
  params.discontinuities = false;
  Known none;
  LightMesh mesh;
  LUXEL_TRY_STATUS(triangulate_all({s, scene, tracer, params, slack_of(s)}, none, mesh, progress));
  for (const LightTriangle& t : mesh.triangles)
    mesh.interpolant.push_back({Rgb{}, {}, {}, {}, {}, s.light.elements[t.leaf].irradiance});
  return mesh;
}

std::optional<MeshPoint> locate(const Solution& s, const LightMesh& mesh, uint32_t face,
                                DVec3 place) {
  if (mesh.triangles.empty()) return std::nullopt;
  const size_t leaf = leaf_at(s.tree, s.faces, face, place);
  MeshPoint best;
  double deepest = -INFINITY;
  for (uint32_t t = mesh.first_of_element[leaf]; t < mesh.first_of_element[leaf + 1]; ++t) {
    const auto& v = mesh.triangles[t].vertex;
    const DVec3 a = mesh.vertices[v[0]], e1 = mesh.vertices[v[1]] - a, e2 = mesh.vertices[v[2]] - a;
    const double a11 = dot(e1, e1), a12 = dot(e1, e2), a22 = dot(e2, e2),
                 det = a11 * a22 - a12 * a12;
    if (!(det > 0)) continue;
    const double b1 = dot(e1, place - a), b2 = dot(e2, place - a);
    const double u = (a22 * b1 - a12 * b2) / det, w = (a11 * b2 - a12 * b1) / det;
    const double depth = std::min({u, w, 1 - u - w});
    if (depth > deepest) deepest = depth, best = {t, float(u), float(w)};
  }
  best.s = std::clamp(best.s, 0.0f, 1.0f), best.t = std::clamp(best.t, 0.0f, 1 - best.s);
  return best;
}

Rgb irradiance_at(const Solution& s, const LightMesh& mesh, const scene::Scene& scene,
                  const scene::SurfacePoint& p) {
  const FacePoint place = face_point_of(scene, s.faces, p);
  if (place.face == kNone) return {};
  const std::optional<MeshPoint> at = locate(s, mesh, place.face, place.position);
  return at ? max(Rgb{}, value_of(mesh.interpolant[at->triangle], at->s, at->t)) : Rgb{};
}

}  // namespace luxel::hierarchical
