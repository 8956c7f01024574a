#include "luxel/view/hemicube/vertex_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "luxel/light/direct_light.h"
#include "luxel/transport/elements.h"

namespace luxel::view {
namespace {

hemicube::Senders senders_of(const LightMesh& mesh) {
  return {mesh.in->scene, *mesh.in->tracer,           mesh.mesh,
          mesh.receivers, mesh.emission.exact.around, mesh.emission.by_pixels};
}

hemicube::Viewpoint viewpoint_of(const LightMesh& mesh, uint32_t element) {
  const transport::Elements& e = mesh.receivers.elements;
  return {e.position[element], e.normal[element], e.geometric_normal[element]};
}

/// The row, and the light that comes with it.
Status look_around(const LightMesh& mesh, uint32_t element, Progress& progress, VertexReport& out) {
  const std::array<hemicube::Viewpoint, 1> from{viewpoint_of(mesh, element)};
  Rgb gathered{};
  const auto done = [&](size_t, const hemicube::View& view) -> Status {
    out.row = view.share;
    out.sum = std::accumulate(view.share.begin(), view.share.end(), 0.0f);
    for (size_t k = 0; k < view.element.size(); ++k)
      gathered += mesh.receivers.elements.reflectance[view.element[k]] *
                  out.light[view.element[k]] * view.share[k];
    out.direct = view.emitted;
    return {};
  };
  LUXEL_TRY_STATUS(
      hemicube::look(senders_of(mesh), from, {out.resolution}, done, progress).map([](auto) {}));
  const std::array<uint32_t, 1> which{element};
  LUXEL_TRY(
      const light::DirectLight direct,
      light::direct_light(
          mesh.in->scene, transport::subset(mesh.receivers.elements, which), mesh.emission.exact,
          *mesh.in->tracer,
          {.samples = mesh.params.direct_samples, .seed = mesh.params.seed, .same_points = true},
          progress));
  out.direct += direct.irradiance[0];
  out.irradiance = out.direct + gathered;
  return {};
}

/// Sums the form factors that are missing from 1: of surroundings, of backs, and of what lies
/// below.
void count_missing(VertexReport& out) {
  double open = 0, back = 0, below = 0;
  for (size_t i = 0; i < out.items.items.size(); ++i) {
    const double factor = out.items.factor[i];
    switch (out.items.items[i].kind) {
      case hemicube::SeenKind::surroundings:
        open += factor;
        break;
      case hemicube::SeenKind::back:
        back += factor;
        break;
      case hemicube::SeenKind::below:
        below += factor;
        break;
      case hemicube::SeenKind::surface:
        break;
    }
  }
  out.open = float(open), out.back = float(back), out.below = float(below);
}

}  // namespace

std::vector<double> factors_of_triangles(const LightMesh& mesh, const hemicube::ItemBuffer& items) {
  const std::vector<uint32_t>& first = mesh.mesh.first_triangle;
  std::vector<double> out(first.back());
  for (size_t i = 0; i < items.items.size(); ++i) {
    if (items.items[i].kind != hemicube::SeenKind::surface) continue;
    const hemicube::Node& node = mesh.mesh.nodes[items.items[i].at.node];
    out[first[node.instance] + node.triangle] += items.factor[i];
  }
  return out;
}

Result<VertexReport> report_on(const LightMesh& mesh, std::vector<Rgb> irradiance, uint32_t element,
                               int resolution, Progress& progress) {
  VertexReport out;
  out.element = element, out.resolution = resolution;
  out.position = mesh.receivers.elements.position[element];
  out.light = std::move(irradiance);
  LUXEL_TRY_STATUS(look_around(mesh, element, progress, out));
  LUXEL_TRY(out.items, hemicube::item_buffer(senders_of(mesh), viewpoint_of(mesh, element),
                                             resolution, progress));
  count_missing(out);
  LUXEL_TRY(const auto exact, exact_factors(mesh, element, progress));
  if (!exact) return out;
  const std::vector<double> found = factors_of_triangles(mesh, out.items);
  out.exact.emplace();
  for (size_t i = 0; i < found.size(); ++i) {
    out.exact->sum += (*exact)[i];
    out.exact->wrong += std::abs((*exact)[i] - found[i]) / 2;
  }
  return out;
}

std::unique_ptr<ReportWorker> begin_reports() {
  return std::make_unique<ReportWorker>(
      [](ReportRequest asked, const ReportWorker::Hand& hand, Progress& progress) -> Status {
        LUXEL_TRY(VertexReport report, report_on(*asked.mesh, std::move(asked.irradiance),
                                                 asked.element, asked.resolution, progress));
        hand({std::move(asked.mesh), std::move(report)});
        return {};
      });
}

std::array<uint32_t, kFactorBins> histogram_of_row(std::span<const float> row) {
  std::array<uint32_t, kFactorBins> out{};
  for (const float factor : row) {
    if (!(factor > 0)) continue;
    const double at = (std::log10(double(factor)) + 7) * 4;
    ++out[size_t(std::clamp(at, 0.0, double(kFactorBins - 1)))];
  }
  return out;
}

uint32_t nearest_element(const LightMesh& mesh, const scene::SurfacePoint& p) {
  const hemicube::MeshPoint at = hemicube::locate(mesh.mesh, p);
  if (mesh.receivers.kind == hemicube::ElementKind::triangle)
    return mesh.receivers.leaf_of_node[at.node];
  const hemicube::Node& node = mesh.mesh.nodes[at.node];
  const Vec3 place = scene::world_position(mesh.in->scene, p);
  const auto away = [&](size_t k) { return length(mesh.mesh.points[node.point[k]] - place); };
  size_t nearest = 0;
  for (size_t k = 1; k < 3; ++k)
    if (away(k) < away(nearest)) nearest = k;
  return node.vertex[nearest];
}

}  // namespace luxel::view
