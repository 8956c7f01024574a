#include "luxel/solve/hemicube/hemicube.h"

#include <cmath>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/forget_at_end.h"
#include "luxel/solve/hemicube/exchange.h"
#include "luxel/solve/hemicube/look_device.h"
#include "luxel/solve/hemicube/refine.h"

namespace luxel::hemicube {
namespace {

constexpr size_t kDefaultElements = 20000;
/// The part of the elements that the first mesh may have when more are to be cut where they are
/// needed. A larger part leaves too few for the borders of shadows; with a smaller one, shadows
/// that fall between the first vertices are not found.
constexpr double kFirstShare = 0.35;

size_t element_count(const Mesh& mesh, ElementKind kind) {
  return kind == ElementKind::vertex ? mesh.vertices.size() : mesh.triangle_count;
}

double area_m2(const scene::Scene& scene) {
  double sum = 0;
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t + first[i] < first[i + 1]; ++t)
      sum += scene::area_m2(scene::world_triangle(scene, i, t));
  return sum;
}

struct FirstMesh {
  Mesh mesh;
  size_t max_elements = 0;
};

/// Legs grow by 12 % from one attempt to the next, and elements become fewer by 1 - 1.12^-2 = 20 %:
/// the mesh that fits has at least about four fifths of the goal. Larger steps waste more of it,
/// smaller ones build more meshes in vain.
constexpr double kLargerLegs = 1.12;
/// After 24 attempts legs are 1.12^24 = 15 times as long: the scene's own triangles are what
/// counts.
constexpr int kMaxAttempts = 24;

/// The finest mesh of about `goal` elements: legs h give area / h^2 vertices, and twice as many
/// triangles. Rims and small triangles add to that, so larger legs are tried until it fits.
Result<Mesh> mesh_of_about(const scene::Scene& scene, const HemicubeParams& params, size_t goal,
                           Mesh own, Progress& progress) {
  const double per_area = params.elements == ElementKind::vertex ? 1 : 2;
  double size_m = std::sqrt(per_area * area_m2(scene) / double(goal));
  for (int attempt = 0; attempt < kMaxAttempts && size_m > 0; ++attempt, size_m *= kLargerLegs) {
    // Triangles are twice the vertices, but for rims.
    const Result<Mesh> mesh =
        make_mesh(scene, {.element_size_m = float(size_m), .max_vertices = 2 * goal}, progress);
    if (mesh && element_count(*mesh, params.elements) <= goal) return mesh;
    if (!mesh && mesh.error().code == ErrorCode::cancelled) return mesh;
  }
  return own;
}

Result<FirstMesh> first_mesh(const scene::Scene& scene, const HemicubeParams& params,
                             Progress& progress) {
  // The scene's own triangles must fit.
  LUXEL_TRY(Mesh own, make_mesh(scene, {}, progress));
  const size_t own_count = element_count(own, params.elements);
  if (own_count == 0)
    return fail(ErrorCode::bad_input, "the scene has no triangle to compute light on");
  if (params.max_elements != 0 && params.max_elements < own_count)
    return fail(ErrorCode::bad_setting,
                "--max-elements {} is less than the {} elements that the scene has before any "
                "triangle is cut; give at least that many",
                params.max_elements, own_count);
  FirstMesh out;
  out.max_elements = params.max_elements != 0
                         ? params.max_elements
                         : std::max(kDefaultElements, own_count + own_count / 2);
  // Elements of a given size, if they fit.
  if (params.element_size_m > 0) {
    LUXEL_TRY(out.mesh,
              make_mesh(scene,
                        {.element_size_m = params.element_size_m, .max_vertices = out.max_elements},
                        progress));
    if (element_count(out.mesh, params.elements) > out.max_elements)
      return fail(
          ErrorCode::bad_setting,
          "elements of {} m are {}, more than --max-elements {}; give a larger --element-size",
          params.element_size_m, element_count(out.mesh, params.elements), out.max_elements);
    return out;
  }
  // Else as small as their number allows, less those that are to be cut later.
  const double share = params.max_error > 0 ? kFirstShare : 1;
  const size_t goal = size_t(share * double(out.max_elements));
  if (own_count >= goal) {
    out.mesh = std::move(own);
    return out;
  }
  LUXEL_TRY(out.mesh, mesh_of_about(scene, params, goal, std::move(own), progress));
  return out;
}

/// Lets all elements of the solution's field look at its own mesh and exchange light, from the
/// light it has on, if any.
Status exchange_light(const scene::Scene& scene, const trace::RayTracer& tracer,
                      const Emission& emission, const HemicubeParams& params, Solution& s,
                      Progress& progress, const Observer& observer) {
  const Receivers& receivers = s.field.receivers;
  LUXEL_TRY(const Sight sight,
            look_from({scene, tracer, emission, s.field.mesh, receivers, &observer},
                      receivers.elements, params, s, progress));
  s.hidden = sight.rows.hidden, s.enclosed = sight.rows.enclosed, s.covered = sight.rows.covered;
  s.row_bytes_in_file = sight.rows.store.bytes_in_file();
  s.row_bytes = sight.rows.store.bytes_in_memory() + s.row_bytes_in_file;
  LUXEL_TRY(Exchanged exchanged,
            exchange(receivers, sight.rows, sight.source,
                     plan_refill(receivers.neighbours, s.enclosed, s.covered), s.field.irradiance,
                     {params.bounces, params.tolerance, observer.on_bounce}, progress));
  s.field.irradiance = std::move(exchanged.irradiance);
  s.sweeps = exchanged.sweeps;
  return {};
}

/// Where the mesh is to be cut shows in coarse hemicubes, too. The light that it ends with is a
/// start only: fine receivers beside a crease see steep light across it as coarse triangles have
/// it.
Status refine_roughly(const scene::Scene& scene, const trace::RayTracer& tracer,
                      const Emission& emission, const HemicubeParams& params, size_t max_elements,
                      Solution& s, Progress& progress, const Observer& observer) {
  HemicubeParams rough = params;
  rough.resolution = std::max(2, params.resolution / 4 * 2);
  LUXEL_TRY_STATUS(exchange_light(scene, tracer, emission, rough, s, progress, observer));
  const Field coarse = s.field;
  LUXEL_TRY_STATUS(refine({scene, tracer, emission, coarse.mesh, coarse.receivers}, rough,
                          max_elements, s, progress));
  if (observer.on_mesh) observer.on_mesh(s.field);
  return {};
}

}  // namespace

uint64_t bytes_of_hemicube(int resolution, int threads) {
  // A pixel has a direction and two weights while it is made; each thread holds a batch of rays.
  const uint64_t pixels = pixels_of(resolution);
  return pixels * 40 + uint64_t(threads) * std::min<uint64_t>(pixels, 16384) * 64;
}

Result<Solution> solve(const scene::Scene& scene, const light::Lights& lights,
                       const trace::RayTracer& tracer, const HemicubeParams& params,
                       Progress& progress, const Observer& observer) {
  LUXEL_CHECK(params.resolution >= 2 && params.resolution <= kMaxResolution &&
              params.resolution % 2 == 0);
  LUXEL_TRY(FirstMesh first, first_mesh(scene, params, progress));
  const ForgetAtEnd use{params.device};
  if (params.device) LUXEL_TRY_STATUS(params.device->begin(scene));
  const Emission emission = choose_emission(lights);
  Solution s;
  // The leg of a right isosceles triangle of mean area.
  s.element_size_m =
      float(std::sqrt(2 * area_m2(scene) / double(std::max<size_t>(first.mesh.triangle_count, 1))));
  s.field.receivers = make_receivers(scene, first.mesh, params.elements);
  step_off_walls(scene, tracer, first.mesh, s.field.receivers);
  s.field.mesh = std::move(first.mesh);
  if (observer.on_mesh) observer.on_mesh(s.field);
  if (params.max_error > 0)
    LUXEL_TRY_STATUS(
        refine_roughly(scene, tracer, emission, params, first.max_elements, s, progress, observer));
  LUXEL_TRY_STATUS(exchange_light(scene, tracer, emission, params, s, progress, observer));
  s.relative_error = relative_interpolation_error(s.field);
  if (params.smooth && params.elements == ElementKind::triangle) {
    s.field = smoothed(scene, s.field, s.enclosed, s.covered);
    s.hidden.assign(s.field.receivers.size(), 0), s.enclosed = s.covered = s.hidden;
  }
  if (observer.on_solved) observer.on_solved(s);
  return s;
}

}  // namespace luxel::hemicube
