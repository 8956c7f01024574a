// View of one element of the mesh: its row of form factors, its hemicube's faces, and the errors of
// both. [Cohen85; Rodriguez06, section 5.6]
#pragma once

#include <optional>
#include <span>

#include "luxel/base/worker.h"
#include "luxel/solve/hemicube/item_buffer.h"
#include "luxel/view/hemicube/live_hemicube.h"

namespace luxel::view {

/// Form factors in closed form, past all that stands in between.
struct ExactRow {
  double sum = 0;
  /// The part of all light that the hemicube takes from wrong triangles of the scene: half the sum
  /// of what their factors differ by.
  double wrong = 0;
};

struct VertexReport {
  uint32_t element = 0;
  int resolution = 0;
  Vec3 position{};                ///< that it looks from [m]
  std::vector<float> row;         ///< form factors that are not 0, of the elements that are seen
  float sum = 0;                  ///< of the row
  float open = 0, back = 0;       ///< what is missing from 1: surroundings, backs, which are black,
  float below = 0;                ///< and what lies below the element's own triangle
  Rgb irradiance{};               ///< that it gathers from the light of the mesh as it is [W/m^2]
  Rgb direct{};                   ///< the part of it straight from lights
  hemicube::ItemBuffer items;     ///< what each pixel sees
  std::optional<ExactRow> exact;  ///< none where exact_factors() has none
  std::vector<Rgb> light;         ///< E of all elements, by which it was found
};

/// Looks from an element through a hemicube of this size: even, 2 to hemicube::kMaxResolution.
/// `irradiance` is E of all elements of the mesh. Errors: cancelled.
Result<VertexReport> report_on(const LightMesh& mesh, std::vector<Rgb> irradiance, uint32_t element,
                               int resolution, Progress& progress);

/// Arguments of report_on().
struct ReportRequest {
  std::shared_ptr<const LightMesh> mesh;
  std::vector<Rgb> irradiance;
  uint32_t element = 0;
  int resolution = 64;
};
/// A report, and of which mesh it is.
struct ReportOfMesh {
  std::shared_ptr<const LightMesh> mesh;
  VertexReport report;
};
using ReportWorker = Worker<ReportRequest, ReportOfMesh>;
std::unique_ptr<ReportWorker> begin_reports();

/// The form factors from an element to the scene's triangles, in their order
/// (scene::first_triangles), in closed form; none where more than some 2,000 can be seen, where
/// light goes through any, or where some coincide. Errors: cancelled.
Result<std::optional<std::vector<double>>> exact_factors(const LightMesh& mesh, uint32_t element,
                                                         Progress& progress);
/// The form factors of all triangles as the hemicube finds them.
std::vector<double> factors_of_triangles(const LightMesh& mesh, const hemicube::ItemBuffer& items);

/// Numbers of a row's factors by powers of ten: bin k holds those from 10^(k/4 - 7) on.
inline constexpr size_t kFactorBins = 28;
std::array<uint32_t, kFactorBins> histogram_of_row(std::span<const float> row);

/// The element nearest to a place of a surface: a vertex of the triangle there, or the triangle.
uint32_t nearest_element(const LightMesh& mesh, const scene::SurfacePoint& p);

}  // namespace luxel::view
