#include "luxel/pipeline/render/draw_hierarchical.h"

#include "luxel/base/parallel.h"
#include "luxel/display/draw.h"
#include "luxel/display/quadratic_view.h"
#include "luxel/pipeline/render/overlays.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::pipeline {
namespace {

using hierarchical::LightMesh;
using hierarchical::Solution;

/// Rays along a pixel's side: exact irradiance costs a good part of a millisecond each.
constexpr int kLerpRaysPerAxis = 2;

HierarchicalSettings settings_of(const RenderSettings& s) {
  return s.hierarchical.value_or(HierarchicalSettings{});
}

hierarchical::SolveParams solve_params(const RenderSettings& s) {
  hierarchical::SolveParams params = settings_of(s).solve;
  params.bounces = s.bounces.value_or(params.bounces);
  return params;
}

/// Light as a picture needs it; stays where it was made.
struct Lit {
  Solution solution;
  LightMesh mesh;  ///< nothing where the picture needs none
};

/// Solves the scene, and makes its light mesh if needed. Warnings and the overlay go to `out`.
Result<Lit> light_up(const Subject& subject, const RenderSettings& s, bool needs_mesh,
                     Rendered& out, Progress& progress) {
  Lit lit;
  LUXEL_TRY(lit.solution,
            hierarchical::solve(subject.scene, subject.tracer, solve_params(s), progress));
  const std::vector<std::string>& warnings = lit.solution.warnings;
  out.warnings.insert(out.warnings.end(), warnings.begin(), warnings.end());
  const hierarchical::MeshParams params = settings_of(s).mesh;
  if (needs_mesh || overlay_needs_mesh(s.overlays)) {
    LUXEL_TRY(lit.mesh, hierarchical::represent(lit.solution, subject.scene, subject.tracer, params,
                                                {}, progress));
  }
  LUXEL_TRY(out.overlay, overlay_lines(s.overlays, lit.solution, lit.mesh, subject.scene,
                                       subject.tracer, params, progress));
  return lit;
}

display::DrawParams draw_params(const RenderSettings& s) {
  display::DrawParams params;
  params.width = s.width, params.height = s.height;
  params.samples_per_axis = kLerpRaysPerAxis;
  return params;
}

/// The k-th of a pixel's rays.
trace::Ray sample_ray(const trace::CameraRays& camera, int width, size_t pixel, int k) {
  const size_t x = pixel % size_t(width), y = pixel / size_t(width);
  return camera.through(float(x) + (float(k % kLerpRaysPerAxis) + 0.5f) / kLerpRaysPerAxis,
                        float(y) + (float(k / kLerpRaysPerAxis) + 0.5f) / kLerpRaysPerAxis);
}

/// Hits of all pixels' rays, pixel after pixel.
std::vector<trace::Hit> hits_of(const Subject& subject, const RenderSettings& s) {
  const trace::CameraRays camera(subject.camera, s.width, s.height);
  constexpr int n = kLerpRaysPerAxis;
  std::vector<trace::Hit> hits(size_t(s.width) * size_t(s.height) * n * n);
  parallel_for(size_t(s.height), 1, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      std::vector<trace::Ray> rays;
      for (size_t x = 0; x < size_t(s.width); ++x)
        for (int k = 0; k < n * n; ++k)
          rays.push_back(sample_ray(camera, s.width, y * size_t(s.width) + x, k));
      const std::vector<trace::Hit> row = trace::visible_hits(subject.scene, subject.tracer, rays);
      std::copy(row.begin(), row.end(), hits.begin() + std::ptrdiff_t(y * row.size()));
    }
  });
  return hits;
}

/// The mean radiance of each pixel's hits.
image::Image picture_of(const Subject& subject, const RenderSettings& s,
                        std::span<const trace::Hit> hits, std::span<const Rgb> irradiance) {
  const trace::CameraRays camera(subject.camera, s.width, s.height);
  image::Image picture(s.width, s.height, 4);
  constexpr size_t n2 = size_t(kLerpRaysPerAxis * kLerpRaysPerAxis);
  for (size_t pixel = 0; pixel * n2 < hits.size(); ++pixel)
    for (size_t k = pixel * n2; k < (pixel + 1) * n2; ++k) {
      const Vec3 direction = sample_ray(camera, s.width, pixel, int(k % n2)).direction;
      Rgb c = scene::smooth_surroundings_towards(subject.scene, direction);
      if (hits[k].found()) {
        const scene::SurfacePoint p = hits[k].point();
        c = scene::emission_at(subject.scene, p) +
            scene::reflectance_at(subject.scene, p) * irradiance[k] * (1 / kPi);
      }
      float* to = picture.data.data() + 4 * pixel;
      to[0] += c.x / float(n2), to[1] += c.y / float(n2), to[2] += c.z / float(n2);
      to[3] += hits[k].found() ? 1 / float(n2) : 0.0f;
    }
  return picture;
}

Result<image::Image> draw_linear(const Subject& subject, const RenderSettings& s,
                                 const Solution& solution, const LightMesh& mesh,
                                 Progress& progress) {
  const auto irradiance = [&](const scene::SurfacePoint& p) -> Rgb {
    const hierarchical::FacePoint place =
        hierarchical::face_point_of(subject.scene, solution.faces, p);
    if (place.face == hierarchical::kNone) return {};
    const auto at = hierarchical::locate(solution, mesh, place.face, place.position);
    if (!at) return {};
    const hierarchical::Interpolant& r = mesh.interpolant[at->triangle];
    return hierarchical::value_of(r, 0, 0) * (1 - at->s - at->t) +
           hierarchical::value_of(r, 1, 0) * at->s + hierarchical::value_of(r, 0, 1) * at->t;
  };
  return display::draw(subject.scene, subject.tracer, subject.camera, irradiance, draw_params(s),
                       progress);
}

}  // namespace

display::QuadraticMesh quadratic_mesh(const scene::Scene& scene, const Solution& solution,
                                      const LightMesh& mesh) {
  display::QuadraticMesh out;
  for (const DVec3& p : mesh.vertices) out.vertices.push_back(to_float(p));
  out.irradiance = mesh.interpolant;
  out.background = scene.background, out.environment = scene.environment;
  for (const hierarchical::LightTriangle& t : mesh.triangles) {
    const hierarchical::ElementLight& light = solution.light.elements[t.leaf];
    out.triangles.push_back(t.vertex);
    out.reflectance.push_back(light.reflectance);
    out.emission.push_back(light.emission * (1 / kPi));
    out.two_sided.push_back(solution.faces.faces[t.face].two_sided);
  }
  return out;
}

Result<image::Image> draw_flat(const Subject& subject, const RenderSettings& s, Rendered& out,
                               Progress& progress) {
  LUXEL_TRY(const Lit lit, light_up(subject, s, false, out, progress));
  const Solution& solution = lit.solution;
  const auto irradiance = [&](const scene::SurfacePoint& p) -> Rgb {
    const hierarchical::FacePoint place =
        hierarchical::face_point_of(subject.scene, solution.faces, p);
    if (place.face == hierarchical::kNone) return {};
    const size_t leaf =
        hierarchical::leaf_at(solution.tree, solution.faces, place.face, place.position);
    return solution.light.elements[leaf].irradiance;
  };
  return display::draw(subject.scene, subject.tracer, subject.camera, irradiance, draw_params(s),
                       progress);
}

Result<image::Image> draw_gouraud(const Subject& subject, const RenderSettings& s, Rendered& out,
                                  Progress& progress) {
  LUXEL_TRY(const Lit lit, light_up(subject, s, true, out, progress));
  hierarchical::MeshParams params = settings_of(s).mesh;
  params.discontinuities = false;
  LUXEL_TRY(const LightMesh whole, hierarchical::make_light_mesh(lit.solution, subject.scene,
                                                                 subject.tracer, params, progress));
  return draw_linear(subject, s, lit.solution, whole, progress);
}

Result<image::Image> draw_gouraud_disc(const Subject& subject, const RenderSettings& s,
                                       Rendered& out, Progress& progress) {
  LUXEL_TRY(const Lit lit, light_up(subject, s, true, out, progress));
  return draw_linear(subject, s, lit.solution, lit.mesh, progress);
}

Result<image::Image> draw_interpolant(const Subject& subject, const RenderSettings& s,
                                      Rendered& out, Progress& progress) {
  LUXEL_TRY(const Lit lit, light_up(subject, s, true, out, progress));
  LUXEL_TRY(const display::QuadraticView view,
            display::QuadraticView::make(quadratic_mesh(subject.scene, lit.solution, lit.mesh)));
  progress.begin("draw", 0);
  return view.draw(subject.camera, s.width, s.height);
}

Result<image::Image> draw_lerpshade(const Subject& subject, const RenderSettings& s, Rendered& out,
                                    Progress& progress) {
  LUXEL_TRY(const Lit lit, light_up(subject, s, true, out, progress));
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return hierarchical::irradiance_at(lit.solution, lit.mesh, subject.scene, p);
  };
  return display::draw(subject.scene, subject.tracer, subject.camera, irradiance, draw_params(s),
                       progress);
}

Result<image::Image> draw_rayshade(const Subject& subject, const RenderSettings& s, Rendered& out,
                                   Progress& progress) {
  LUXEL_TRY(const Lit lit, light_up(subject, s, true, out, progress));
  const Solution& solution = lit.solution;
  const std::vector<trace::Hit> hits = hits_of(subject, s);
  std::vector<hierarchical::Receiver> receivers;
  std::vector<size_t> hit_of;
  for (size_t k = 0; k < hits.size(); ++k) {
    if (!hits[k].found()) continue;
    const hierarchical::FacePoint place =
        hierarchical::face_point_of(subject.scene, solution.faces, hits[k].point());
    if (place.face == hierarchical::kNone) continue;
    receivers.push_back(hierarchical::receiver_at(solution, subject.scene, subject.tracer,
                                                  place.face, place.position));
    hit_of.push_back(k);
  }
  LUXEL_TRY(const std::vector<Rgb> light,
            hierarchical::irradiance_at(solution, subject.scene, subject.tracer, receivers, {1e-3},
                                        progress));
  std::vector<Rgb> irradiance(hits.size());
  for (size_t k = 0; k < light.size(); ++k) irradiance[hit_of[k]] = light[k];
  return picture_of(subject, s, hits, irradiance);
}

}  // namespace luxel::pipeline
