#include "luxel/validate/exact_measure.h"

#include <algorithm>
#include <cmath>

#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/off_surface.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::validate {
namespace {

/// E and its standard error at each of some places.
struct Answers {
  std::vector<scene::SurfacePoint> at;
  std::vector<float> irradiance, standard_error;
};

Answers read_lightmap(const Prepared& p, const pipeline::TexelLight& light, size_t count) {
  Answers out{scene::points_uniform_in_area(p.scene, count, 1), {}, {}};
  const transport::TexelField field{&p.atlas, &p.map, light.irradiance};
  for (const scene::SurfacePoint& at : out.at)
    out.irradiance.push_back(transport::irradiance_at(field, at).x);
  return out;
}

Result<Answers> follow_paths(const Prepared& p, const MeasureEffort& effort, Progress& progress) {
  Answers out{scene::points_uniform_in_area(p.scene, effort.path_points, 1), {}, {}};
  std::vector<Vec3> position, normal;
  for (const scene::SurfacePoint& at : out.at) {
    normal.push_back(scene::front_normal(p.scene, at.instance, at.triangle));
    position.push_back(scene::off_surface(p.scene, at, normal.back()));
  }
  LUXEL_TRY(const reference::TexelPaths paths,
            reference::irradiance_by_paths(p.scene, {position, normal, normal}, *p.tracer,
                                           {.samples = effort.paths_per_point}, progress));
  for (const Rgb& e : paths.irradiance) out.irradiance.push_back(e.x);
  for (const Rgb& e : paths.standard_error) out.standard_error.push_back(e.x);
  return out;
}

Measured mean_of(const Prepared& p, const ExactPart& part, const Answers& answers) {
  Measured out;
  double count = 0, variance = 0;
  for (size_t i = 0; i < answers.at.size(); ++i) {
    if (!part.contains(p.scene, answers.at[i])) continue;
    out.exact += part.irradiance(scene::world_position(p.scene, answers.at[i]));
    out.mean += double(answers.irradiance[i]);
    if (!answers.standard_error.empty())
      variance += double(answers.standard_error[i]) * double(answers.standard_error[i]);
    ++count;
  }
  out.exact /= count, out.mean /= count;
  out.standard_error = std::sqrt(variance) / count;
  return out;
}

double texel_rms(const Prepared& p, const ExactPart& part, const pipeline::TexelLight& light,
                 double mean_exact) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < p.map.texels.size(); ++i) {
    if (!part.contains(p.scene, p.map.texels[i].sample)) continue;
    // Against the mean where the exact value is nearly 0: in an umbra.
    const double exact = part.irradiance(p.elements.position[i]);
    const double d = (double(light.irradiance[i].x) - exact) / std::max(exact, 0.1 * mean_exact);
    sum += d * d, ++count;
  }
  return std::sqrt(sum / count);
}

}  // namespace

bool is_ready_for(std::string_view solver, const ExactCase& c) {
  if (solver != "hierarchical") return true;
  return c.name.find("sphere") == std::string::npos;
}

Result<std::vector<Measured>> measure(const Prepared& p, const ExactCase& c,
                                      std::string_view solver, const MeasureEffort& effort,
                                      Progress& progress) {
  const bool by_paths = solver == "reference";
  pipeline::BakeSettings settings;
  settings.samples = by_paths ? effort.paths : effort.rays;
  settings.direct_samples = effort.shadow_rays;
  // Three vertices for each flat triangle.
  const int64_t elements = std::max(effort.elements, 3 * int64_t(p.atlas.corners.size()) + 64);
  auto& hemicube = settings.own.of<hemicube::HemicubeParams>();
  hemicube.max_elements = size_t(elements);
  hemicube.resolution = elements > 4 * effort.elements ? 16 : effort.hemicube;
  settings.own.of<matrix::MatrixParams>().patches.count = size_t(effort.patches);
  LUXEL_TRY(const Timed solved, solve(p, solver, settings, progress));
  Answers answers;
  if (by_paths) {
    LUXEL_TRY(answers, follow_paths(p, effort, progress));
  } else {
    answers = read_lightmap(p, solved.light, effort.lightmap_points);
  }
  std::vector<Measured> out;
  for (const ExactPart& part : c.parts) {
    out.push_back(mean_of(p, part, answers));
    if (part.pointwise) out.back().texel_rms = texel_rms(p, part, solved.light, out.back().exact);
  }
  return out;
}

}  // namespace luxel::validate
