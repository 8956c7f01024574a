#include "luxel/solve/hierarchical/represent.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/clock.h"
#include "luxel/solve/hierarchical/feedback.h"

namespace luxel::hierarchical {
namespace {

/// A triangle whose samples are off a plane by less than this part of what its interpolant may be
/// off by is not looked at.
constexpr double kRepresentFlat = 0.25;
/// The usual eps of interpolants over that of links. Feedback corrects what links err by, while the
/// error of an interpolant stays in the picture. Smaller divides more elements for it.
constexpr double kUsualPart = 0.25;
/// Light at points only says what to divide and to correct before the last mesh: it may be so much
/// less exact.
constexpr double kRougher = 4;
/// Sources may be wrong at points by this part of what interpolants may be off by; but no less than
/// that of the mean light.
/// Sources differ, so that the errors of several add up to less than eps.
constexpr double kExacter = 0.2, kExactest = 1e-5;
/// When light has changed by no more than so many eps, the next change would be half of eps: each
/// is a fifth of the one before, or less.
constexpr double kSettled = 2.5;
constexpr int kMostFeedbacks = 4;
/// The last mesh takes so many times as long as those before it, at most.
constexpr double kLastMesh = 2;
/// The work that is mostly to come, in times of the slowest mesh so far: after a mesh that says
/// what to divide, after all of these, and after one that something was fed back into.
constexpr double kToComeWhileRefining = 4.5, kToComeWhileSettling = 3.3, kToComeAtLast = 1.6;

/// A solution, and how light at its points is computed.
struct PointScene {
  const Solution& s;
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const PointParams& params;
};

/// A solution that is refined, and what earlier meshes of it found.
struct Refining {
  Solution& s;
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const MeshParams& params;  ///< of all meshes but the last
  double eps = 0;            ///< how far interpolants may be off [W/m^2]
  Known& known;

  PointScene points() const { return {s, scene, tracer, params.point}; }
};

double area_of(const LightMesh& mesh, const LightTriangle& t) {
  const DVec3 a = mesh.vertices[t.vertex[0]];
  return 0.5 * length(cross(mesh.vertices[t.vertex[1]] - a, mesh.vertices[t.vertex[2]] - a));
}

/// The largest difference between the middles of edges and the means of their ends.
float bend_of(const Interpolant& r) {
  const Rgb a = value_of(r, 0, 0), b = value_of(r, 1, 0), c = value_of(r, 0, 1);
  float bend = 0;
  for (const Rgb& d :
       {value_of(r, 0.5f, 0) - (a + b) * 0.5f, value_of(r, 0.5f, 0.5f) - (b + c) * 0.5f,
        value_of(r, 0, 0.5f) - (c + a) * 0.5f})
    bend = std::max({bend, max_component(d), max_component(-d)});
  return bend;
}

/// Per triangle; 0 for those that are not asked for.
Result<std::vector<float>> measure(const PointScene& at, std::span<const size_t> triangles,
                                   KnownLight& known, const LightMesh& mesh, Progress& progress) {
  std::vector<Receiver> receivers;
  for (const size_t k : triangles) {
    const LightTriangle& t = mesh.triangles[k];
    receivers.push_back(receiver_at(at.s, at.scene, at.tracer, t.face, middle_of(mesh, t)));
  }
  LUXEL_TRY(const std::vector<Rgb> e, continuous_irradiance_at(at.s, at.scene, at.tracer, receivers,
                                                               at.params, known, progress));
  LUXEL_TRY(const std::vector<Rgb> sharp,
            sharp_irradiance_at(at.scene, at.tracer, receivers, progress));
  std::vector<float> error(mesh.triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i) {
    const Rgb d = e[i] + sharp[i] - value_of(mesh.interpolant[triangles[i]], 1 / 3.0f, 1 / 3.0f);
    error[triangles[i]] = std::max(max_component(d), max_component(-d));
  }
  return error;
}

/// Leaves whose interpolants are off by more than eps, looked for where triangles are bent.
Result<std::vector<size_t>> leaves_off(const PointScene& at, double eps, KnownLight& known,
                                       const LightMesh& mesh, Progress& progress) {
  const double unit_m2 = at.s.unit_area_m2;
  std::vector<size_t> bent;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    if (double(bend_of(mesh.interpolant[t])) *
            std::sqrt(area_of(mesh, mesh.triangles[t]) / unit_m2) >
        kRepresentFlat * eps)
      bent.push_back(t);
  LUXEL_TRY(const std::vector<float> error, measure(at, bent, known, mesh, progress));
  std::vector<size_t> out;
  for (size_t e = 0; e < at.s.tree.elements.size(); ++e) {
    double squares = 0;
    for (uint32_t t = mesh.first_of_element[e]; t < mesh.first_of_element[e + 1]; ++t)
      squares += double(error[t]) * double(error[t]) * area_of(mesh, mesh.triangles[t]);
    if (squares > eps * eps * unit_m2 && at.s.tree.elements[e].area_m2 > 4 * at.s.min_area_m2)
      out.push_back(e);
  }
  return out;
}

void divide_all(Refining& r, std::span<const size_t> leaves, size_t max_elements) {
  Solution& s = r.s;
  const Exchange x = s.exchange(r.tracer);
  Refined state{r.scene, s.tree, s.light, s.links};
  drop_pieces(s.light);  // theirs are the elements there were
  for (const size_t leaf : leaves) {
    if (s.tree.elements.size() + 4 > max_elements) break;
    divide_element(state, x, leaf);
  }
}

/// Precision of light: `rough` for meshes that say what to divide, `fine` for the last one.
struct Precision {
  MeshParams rough, fine;
  double eps = 0;  ///< how far interpolants may be off [W/m^2]
};

/// The precision that light at points needs, by the error that interpolants may have.
Precision precision_of(const Solution& s, const MeshParams& mesh_params,
                       const RepresentParams& params) {
  const double mean = double(max_component(totals_of(s).irradiance));
  Precision out{mesh_params, mesh_params, params.eps.value_or(s.eps * kUsualPart)};
  if (mean > 0)
    out.fine.point.tolerance =
        std::clamp(kExacter * out.eps / mean, std::min(kExactest, out.fine.point.tolerance),
                   out.fine.point.tolerance);
  out.rough = out.fine;
  out.rough.point.tolerance *= kRougher;
  out.eps = std::max(out.eps, out.rough.point.tolerance * mean);
  return out;
}

/// The time there is, and what meshes take of it.
struct Timing {
  double seconds = INFINITY;
  Clock::time_point start = Clock::now();
  double mesh_s = 0;   ///< what the slowest mesh took
  double later_s = 0;  ///< what the caller does after it

  double left() const { return seconds - seconds_since(start); }
  /// There is time for another mesh, and for the last one after it, which is more exact.
  bool has_time() const { return left() > (1 + kLastMesh) * mesh_s; }
  /// Tells what is to come, in times of the slowest mesh.
  void expect(double meshes, Progress& progress) const {
    progress.expect_within(std::min(meshes * mesh_s, std::max(left(), 0.0)) + later_s);
  }
};

/// A mesh of the leaves there are.
Result<LightMesh> timed_mesh(Refining& r, Timing& timing, Progress& progress) {
  const Clock::time_point begun = Clock::now();
  LUXEL_TRY(LightMesh mesh, make_light_mesh(r.s, r.scene, r.tracer, r.params, r.known, progress));
  timing.mesh_s = std::max(timing.mesh_s, seconds_since(begun));
  return mesh;
}

/// Feeds back, and gathers anew, until that changes light no more, or the time is short. After the
/// last feedback nothing looks at another mesh.
Status settle(Refining& r, LightMesh mesh, Timing& timing, LeftOut& left_out, Progress& progress) {
  for (int k = 0;; ++k) {
    timing.expect(k == 0 ? kToComeWhileSettling : kToComeAtLast, progress);
    LUXEL_TRY(const double change, feed_back(r.s, r.tracer, mesh, progress));
    if (change <= kSettled * r.eps || k + 1 == kMostFeedbacks) return {};
    left_out.feedback = !timing.has_time();
    if (left_out.feedback) return {};
    r.known.light.at.clear();
    LUXEL_TRY(mesh, timed_mesh(r, timing, progress));
  }
}

}  // namespace

Result<std::vector<float>> measure_error(const Solution& s, const scene::Scene& scene,
                                         const trace::RayTracer& tracer, const PointParams& params,
                                         const LightMesh& mesh, Progress& progress) {
  std::vector<size_t> all(mesh.triangles.size());
  for (size_t t = 0; t < all.size(); ++t) all[t] = t;
  KnownLight none;
  return measure({s, scene, tracer, params}, all, none, mesh, progress);
}

Result<Round> represent_once(Solution& s, const scene::Scene& scene, const trace::RayTracer& tracer,
                             const MeshParams& mesh_params, const RepresentParams& params,
                             Known& known, Progress& progress) {
  const Precision precision = precision_of(s, mesh_params, params);
  Refining r{s, scene, tracer, precision.rough, precision.eps, known};
  Round out;
  LUXEL_TRY(out.mesh, make_light_mesh(s, scene, tracer, r.params, known, progress));
  LUXEL_TRY(const std::vector<size_t> leaves,
            leaves_off(r.points(), r.eps, known.light, out.mesh, progress));
  const size_t before = s.tree.elements.size();
  divide_all(r, leaves, params.max_elements);
  out.divided = (s.tree.elements.size() - before) / 4;
  return out;
}

Result<LightMesh> represent(Solution& s, const scene::Scene& scene, const trace::RayTracer& tracer,
                            const MeshParams& mesh_params, const RepresentParams& params,
                            Progress& progress, LeftOut* left_out) {
  const Precision precision = precision_of(s, mesh_params, params);
  const double eps = precision.eps;
  Known known;
  Refining r{s, scene, tracer, precision.rough, eps, known};
  Timing timing{.seconds = params.seconds, .later_s = params.later_seconds};
  LeftOut out_of_time;
  for (int round = 0;; ++round) {
    // A mesh of the leaves there are, and those whose interpolants are off.
    LUXEL_TRY(LightMesh mesh, timed_mesh(r, timing, progress));
    timing.expect(kToComeWhileRefining, progress);
    LUXEL_TRY(const std::vector<size_t> leaves,
              leaves_off(r.points(), eps, r.known.light, mesh, progress));
    out_of_time.refinement = !leaves.empty() && !timing.has_time();
    if (leaves.empty() || round == params.max_rounds || out_of_time.refinement ||
        s.tree.elements.size() + 4 > params.max_elements) {
      // The solution learns from the mesh, and the last mesh shows what it has learned.
      LUXEL_TRY_STATUS(settle(r, std::move(mesh), timing, out_of_time, progress));
      if (left_out) *left_out = out_of_time;
      timing.expect(kToComeAtLast, progress);
      r.known.light.at.clear();
      return make_light_mesh(s, scene, tracer, precision.fine, r.known, progress);
    }
    divide_all(r, leaves, params.max_elements);
  }
}

}  // namespace luxel::hierarchical
