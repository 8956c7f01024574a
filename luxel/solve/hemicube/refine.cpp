#include "luxel/solve/hemicube/refine.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "luxel/base/parallel.h"
#include "luxel/light/direct_light.h"
#include "luxel/solve/hemicube/bisect.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/covers.h"

namespace luxel::hemicube {
namespace {

/// Elements are added in rounds of at most this part of what there are, so that each round sees
/// where the one before was not enough.
constexpr double kGrowth = 0.25;
/// A mesh grows 1.25^24 = 200 times at most: a bound for first meshes of far too few elements.
constexpr int kMaxRounds = 24;
/// Errors in the dark are held against this part of the scene's mean light: a relative error of
/// hardly any light does not show, and would take the elements of what does.
constexpr float kDark = 0.1f;
/// No edge becomes shorter than this part of the first mesh's mean one: the border of a hard shadow
/// would take all elements there are.
constexpr double kSmallestPart = 1.0 / 32;
/// The last looks have twice the pixels along each edge.
constexpr double kFineOverRoughLook = 4;

float luminance_of(const Field& field, uint32_t element) {
  return luminance(field.irradiance[element]);
}

/// Half a triangle's edge: its leaf, and the slope of light from the edge to the corner opposite.
struct Slope {
  uint32_t leaf = 0;
  float slope = 0, height_m = 0;
};

Slope slope_from_edge(const Field& field, uint32_t leaf, size_t k) {
  const Node& node = field.mesh.nodes[field.receivers.leaves[leaf]];
  const size_t next = (k + 1) % 3, top = (k + 2) % 3;
  const Vec3 a = field.mesh.points[node.point[k]];
  const Vec3 along = field.mesh.points[node.point[next]] - a;
  const Vec3 up = field.mesh.points[node.point[top]] - a;
  const float s = dot(up, along) / std::max(dot(along, along), 1e-30f);
  const float height = length(up - along * s);
  const float at_foot =
      luminance_of(field, node.vertex[k]) * (1 - s) + luminance_of(field, node.vertex[next]) * s;
  const float rise = luminance_of(field, node.vertex[top]) - at_foot;
  return {leaf, height > 0 ? rise / height : 0.0f, height};
}

/// (g_1 + g_2) h / 4 over each edge, h the height of the triangle: interpolation_errors derives it.
std::vector<float> errors_per_vertex(const Field& field, std::span<const uint8_t> unseen) {
  const Receivers& r = field.receivers;
  std::vector<float> error(r.leaves.size());
  std::map<std::pair<uint32_t, uint32_t>, Slope> open;  // edges with one triangle so far
  for (uint32_t leaf = 0; leaf < r.leaves.size(); ++leaf) {
    if (!unseen.empty() && unseen[leaf]) continue;
    const Node& node = field.mesh.nodes[r.leaves[leaf]];
    for (size_t k = 0; k < 3; ++k) {
      const Slope here = slope_from_edge(field, leaf, k);
      const auto [entry, is_first] =
          open.try_emplace(std::minmax(node.vertex[k], node.vertex[(k + 1) % 3]), here);
      if (is_first) continue;
      const Slope there = entry->second;
      const float kink = std::abs(here.slope + there.slope) / 4;
      error[leaf] = std::max(error[leaf], kink * here.height_m);
      error[there.leaf] = std::max(error[there.leaf], kink * there.height_m);
      open.erase(entry);
    }
  }
  return error;
}

std::vector<float> errors_per_triangle(const Field& field, std::span<const uint8_t> unseen) {
  const auto counts = [&](size_t i) { return unseen.empty() || !unseen[i]; };
  std::vector<float> error(field.receivers.size());
  for (uint32_t i = 0; i < error.size(); ++i)
    for (const uint32_t j : field.receivers.neighbours.of(i))
      if (counts(i) && counts(j))
        error[i] =
            std::max(error[i], 0.5f * std::abs(luminance_of(field, i) - luminance_of(field, j)));
  return error;
}

/// Mean irradiance of the corners, or of the triangle.
float mean_luminance(const Field& field, size_t leaf) {
  if (field.receivers.kind == ElementKind::triangle) return luminance_of(field, uint32_t(leaf));
  const auto& v = field.mesh.nodes[field.receivers.leaves[leaf]].vertex;
  return (luminance_of(field, v[0]) + luminance_of(field, v[1]) + luminance_of(field, v[2])) / 3;
}

float area_m2(const Mesh& mesh, uint32_t node) {
  const Node& n = mesh.nodes[node];
  return scene::area_m2(
      {mesh.points[n.point[0]], mesh.points[n.point[1]], mesh.points[n.point[2]]});
}

double mean_luminance(const Field& field) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < field.receivers.leaves.size(); ++i) {
    const double a = area_m2(field.mesh, field.receivers.leaves[i]);
    sum += mean_luminance(field, i) * a, area += a;
  }
  return area > 0 ? sum / area : 0;
}

/// Per leaf, 1 where it lies inside a solid: it has enclosed elements, and its middle is enclosed,
/// too. Where a wall stands across a triangle, the part that is seen may be the larger one.
std::vector<uint8_t> unseen_leaves(const SendingScene& around, const Solution& s) {
  const Receivers& r = s.field.receivers;
  if (r.kind == ElementKind::triangle) return s.enclosed;
  std::vector<uint8_t> out(r.leaves.size());
  std::vector<uint32_t> which, nodes;
  for (uint32_t leaf = 0; leaf < out.size(); ++leaf) {
    const auto& v = s.field.mesh.nodes[r.leaves[leaf]].vertex;
    if (s.enclosed[v[0]] || s.enclosed[v[1]] || s.enclosed[v[2]])
      which.push_back(leaf), nodes.push_back(r.leaves[leaf]);
  }
  const std::vector<uint8_t> enclosed = transport::find_enclosed(
      around.scene, around.tracer, places_of_triangles(around.scene, s.field.mesh, nodes));
  for (size_t k = 0; k < which.size(); ++k) out[which[k]] = enclosed[k];
  return out;
}

/// Triangles to cut, the worst first: those that err by more than `max_error` of their light or, in
/// the dark, of a tenth of the scene's mean, ordered by what they add to the whole error.
std::vector<uint32_t> worst_first(const Field& field, std::span<const uint8_t> unseen,
                                  float max_error, double shortest_m, const Bisector& bisector) {
  const std::vector<float> errors = interpolation_errors(field, unseen);
  const float dark = kDark * float(mean_luminance(field));
  std::vector<std::pair<float, uint32_t>> order;
  for (size_t i = 0; i < errors.size(); ++i) {
    const uint32_t node = field.receivers.leaves[i];
    const float relative = errors[i] / (std::max(mean_luminance(field, i), dark) + 1e-30f);
    if (relative <= max_error || is_flat(field.mesh, field.mesh.nodes[node])) continue;
    if (bisector.longest_edge2(node) < 4 * shortest_m * shortest_m) continue;
    order.push_back({-relative * std::sqrt(area_m2(field.mesh, node)), node});
  }
  std::sort(order.begin(), order.end());
  std::vector<uint32_t> nodes;
  for (const auto& [priority, node] : order) nodes.push_back(node);
  return nodes;
}

/// Moves what is known of elements to the numbers they have in a finer mesh; returns the new ones.
std::vector<uint32_t> carry_over(const Receivers& before, const Receivers& now, Solution& s) {
  std::vector<Rgb> irradiance(now.size());
  std::vector<uint8_t> hidden(now.size()), enclosed(now.size()), covered(now.size());
  std::vector<uint32_t> unknown;
  for (uint32_t i = 0; i < now.size(); ++i) {
    uint32_t old = kNone;
    if (now.kind == ElementKind::vertex)
      old = i < before.size() ? i : kNone;
    else if (now.leaves[i] < before.leaf_of_node.size())
      old = before.leaf_of_node[now.leaves[i]];
    if (old == kNone) {
      unknown.push_back(i);
      continue;
    }
    irradiance[i] = s.field.irradiance[old];
    hidden[i] = s.hidden[old], enclosed[i] = s.enclosed[old], covered[i] = s.covered[old];
  }
  s.field.irradiance = std::move(irradiance);
  s.hidden = std::move(hidden), s.enclosed = std::move(enclosed), s.covered = std::move(covered);
  return unknown;
}

double mean_longest_edge_m(const Mesh& mesh, std::span<const uint32_t> nodes, const Bisector& b) {
  double sum = 0;
  for (const uint32_t node : nodes) sum += std::sqrt(b.longest_edge2(node));
  return nodes.empty() || mesh.nodes.empty() ? 0 : sum / double(nodes.size());
}

}  // namespace

std::vector<float> interpolation_errors(const Field& field, std::span<const uint8_t> unseen) {
  return field.receivers.kind == ElementKind::vertex ? errors_per_vertex(field, unseen)
                                                     : errors_per_triangle(field, unseen);
}

double relative_interpolation_error(const Field& field) {
  const std::vector<float> errors = interpolation_errors(field);
  double sum = 0, area = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    const double a = area_m2(field.mesh, field.receivers.leaves[i]);
    sum += double(errors[i]) * double(errors[i]) * a, area += a;
  }
  const double mean = mean_luminance(field);
  return mean > 0 && area > 0 ? std::sqrt(sum / area) / mean : 0;
}

Result<Sight> look_from(const SendingScene& around, const transport::Elements& elements,
                        const HemicubeParams& params, Solution& solution, Progress& progress) {
  LUXEL_TRY(light::DirectLight direct,
            light::direct_light(around.scene, elements, around.emission.exact, around.tracer,
                                {.samples = params.direct_samples,
                                 .seed = params.seed,
                                 .same_points = true,
                                 .team = params.team},
                                progress));
  const Senders senders{around.scene,
                        around.tracer,
                        around.mesh,
                        around.senders,
                        around.emission.exact.around,
                        around.emission.by_pixels};
  RowParams of_rows{
      .look = {.resolution = params.resolution, .device = params.device, .team = params.team},
      .memory_limit_bytes = params.row_memory_bytes,
      .scratch_folder = params.scratch_folder};
  if (around.observer && around.observer->on_direct) around.observer->on_direct(direct.irradiance);
  if (around.observer && around.observer->on_view)
    of_rows.on_view = [&](size_t i, const View& view) {
      around.observer->on_view(i, direct.irradiance[i] + view.emitted, view);
    };
  LUXEL_TRY(Rows rows, make_rows(senders, viewpoints(elements), of_rows, progress));
  for (size_t k = 0; k < elements.size(); ++k) direct.irradiance[k] += rows.emitted[k];
  const float size_m =
      transport::size_for_covers(around.scene, around.tracer, solution.element_size_m);
  const std::vector<float> open = transport::open_shares(around.tracer, elements, size_m);
  for (const float share : open) rows.covered.push_back(share < 1);
  solution.rays += direct.rays + pixels_of(params.resolution) * elements.size();
  solution.seconds.visibility += rows.seconds.visibility;
  solution.seconds.summation += rows.seconds.summation;
  return Sight{std::move(rows), std::move(direct.irradiance)};
}

namespace {

/// Cuts the worst triangles until there are `goal` elements, or nearly so. False when there is
/// nothing to cut.
bool cut_worst(Field& field, std::span<const uint8_t> unseen, const HemicubeParams& params,
               size_t goal, double shortest_m, Bisector& bisector) {
  const size_t before = field.mesh.nodes.size();
  for (const uint32_t node : worst_first(field, unseen, params.max_error, shortest_m, bisector)) {
    const size_t elements = params.elements == ElementKind::vertex ? field.mesh.vertices.size()
                                                                   : field.mesh.triangle_count;
    if (elements >= goal) break;
    // Each triangle that is cut is one triangle more, and one vertex at most.
    bisector.cut(node, goal - elements);
  }
  return field.mesh.nodes.size() > before;
}

/// Light for new elements, from what the mesh around sends.
Status light_new_elements(const SendingScene& around, const HemicubeParams& params,
                          std::span<const uint32_t> elements, std::span<const Rgb> sent,
                          Solution& s, Progress& progress) {
  LUXEL_TRY(const Sight sight,
            look_from(around, transport::subset(s.field.receivers.elements, elements), params, s,
                      progress));
  std::vector<Rgb> gathered = sight.source;
  if (params.bounces != 0)
    LUXEL_TRY_STATUS(sweep(sight.rows, sight.source, sent, gathered, progress));
  for (size_t k = 0; k < elements.size(); ++k) {
    s.field.irradiance[elements[k]] = gathered[k];
    s.hidden[elements[k]] = sight.rows.hidden[k], s.enclosed[elements[k]] = sight.rows.enclosed[k];
    s.covered[elements[k]] = sight.rows.covered[k];
  }
  refill(plan_refill(s.field.receivers.neighbours, s.enclosed, s.covered), s.field.irradiance);
  return {};
}

/// Tells what is to come: this round and the others, then the last looks of all elements, through
/// four times the pixels, by what looks have taken so far. Rough looks of a round see a part of the
/// elements, and each element is seen by one round.
void expect_looks(size_t now, size_t goal, size_t max_elements, const Solution& s,
                  Progress& progress) {
  const double thread_s = s.seconds.visibility + s.seconds.summation;
  const double each_s = thread_s / double(thread_count()) / double(std::max<size_t>(now, 1));
  std::vector<Stage> looks;
  for (const size_t elements : {goal - now, max_elements - goal})
    if (elements > 0) looks.push_back({"hemicubes", each_s * double(elements)});
  looks.push_back({"hemicubes", kFineOverRoughLook * each_s * double(max_elements)});
  progress.expect(std::move(looks));
}

}  // namespace

Status refine(const SendingScene& around, const HemicubeParams& params, size_t max_elements,
              Solution& s, Progress& progress) {
  const std::vector<Rgb> sent = radiosity(around.senders.elements, s.field.irradiance);
  Bisector bisector(s.field.mesh);
  const double shortest_m =
      kSmallestPart * mean_longest_edge_m(s.field.mesh, around.senders.leaves, bisector);
  for (int round = 0; round < kMaxRounds; ++round) {
    const size_t now = s.field.receivers.size();
    if (now >= max_elements) break;
    const size_t more = std::max<size_t>(64, size_t(kGrowth * double(now)));
    const size_t goal = std::min(max_elements, now + more);
    const std::vector<uint8_t> unseen = unseen_leaves(around, s);
    if (!cut_worst(s.field, unseen, params, goal, shortest_m, bisector)) break;
    expect_looks(now, goal, max_elements, s, progress);
    const Receivers old = std::move(s.field.receivers);
    s.field.receivers = make_receivers(around.scene, s.field.mesh, params.elements);
    step_off_walls(around.scene, around.tracer, s.field.mesh, s.field.receivers);
    const std::vector<uint32_t> unknown = carry_over(old, s.field.receivers, s);
    LUXEL_TRY_STATUS(light_new_elements(around, params, unknown, sent, s, progress));
  }
  const size_t all = s.field.receivers.size();
  expect_looks(all, all, all, s, progress);
  return {};
}

}  // namespace luxel::hemicube
