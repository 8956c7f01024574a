#include "luxel/pipeline/render/overlays.h"

#include <algorithm>
#include <array>

#include "luxel/pipeline/settings/comma_list.h"

namespace luxel::pipeline {
namespace {

namespace h = luxel::hierarchical;
using Lines = std::vector<display::Line>;

constexpr Rgb kGrey{0.25f, 0.25f, 0.25f}, kWhite{1, 1, 1}, kPink{1, 0.5f, 0.7f},
    kGreen{0.1f, 0.7f, 0.2f}, kViolet{0.55f, 0.1f, 0.85f}, kRed{0.9f, 0.1f, 0.1f},
    kYellow{0.95f, 0.85f, 0.1f};
constexpr size_t kMostLinks = 300;
constexpr float kStick = 0.05f;  ///< of the diagonal

constexpr std::array<std::string_view, 6> kNames{"mesh",          "links", "discontinuities",
                                                 "triangulation", "error", "samples"};

void add_mesh(const h::Solution& s, Lines& out) {
  for (const h::Element& e : s.tree.elements) {
    if (!e.is_leaf()) continue;
    for (uint32_t k = 0; k < e.corners; ++k)
      out.push_back({to_float(e.corner[k]), to_float(e.corner[(k + 1) % e.corners]), kGrey});
  }
}

bool cuts(const Plane& plane, const h::Element& e, double slack_m) {
  bool above = false, below = false;
  for (const DVec3& p : e.polygon())
    above |= plane.height(p) > slack_m, below |= plane.height(p) < -slack_m;
  return above && below;
}

Rgb color_of(const h::Solution& s, const h::Element& r, const h::Element& e, const h::Link& link) {
  if (link.visible < 1) return kGreen;
  const Plane &a = s.faces.faces[r.face].plane, &b = s.faces.faces[e.face].plane;
  return cuts(a, e, s.faces.slack_m) || cuts(b, r, s.faces.slack_m) ? kPink : kWhite;
}

void add_links(const h::Solution& s, const trace::RayTracer& tracer, Lines& out) {
  struct Strong {
    double power;
    display::Line line;
  };
  std::vector<Strong> strong;
  const h::Exchange x = s.exchange(tracer);
  for (uint32_t id = uint32_t(s.tree.clusters.size()); id < s.tree.size(); ++id) {
    const h::Element& r = s.tree.element(id);
    for (const h::Link& link : s.links.of[id]) {
      if (s.tree.is_cluster(link.source)) continue;
      const h::Element& e = s.tree.element(link.source);
      const double power = r.area_m2 * double(luminance(h::irradiance_of(link, x, s.light)));
      strong.push_back({power, {to_float(r.centre), to_float(e.centre), color_of(s, r, e, link)}});
    }
  }
  std::stable_sort(strong.begin(), strong.end(),
                   [](const Strong& a, const Strong& b) { return a.power > b.power; });
  for (size_t k = 0; k < std::min(kMostLinks, strong.size()); ++k) out.push_back(strong[k].line);
}

void add_discontinuities(const h::Solution& s, const scene::Scene& scene,
                         const trace::RayTracer& tracer, h::DiscontinuityParams params,
                         Lines& out) {
  params.least_weight = 0;
  const h::DiscontinuityLimits limits = h::limits_of(s, params);
  for (uint32_t f = 0; f < s.faces.size(); ++f)
    for (const h::Discontinuity& d :
         h::find_discontinuities(s, scene, tracer, f, params.ranking, limits))
      out.push_back({to_float(d.a), to_float(d.b), kViolet});
}

void add_triangulation(const h::LightMesh& mesh, Lines& out) {
  for (const h::LightTriangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k)
      out.push_back({to_float(mesh.vertices[t.vertex[k]]),
                     to_float(mesh.vertices[t.vertex[(k + 1) % 3]]),
                     t.edge_is_line[k] ? kViolet : kGreen});
}

struct Stick {
  DVec3 foot;
  DVec3 normal;
  float height;
};

void add_sticks(const h::Solution& s, const std::vector<Stick>& sticks, Rgb color, Lines& out) {
  float most = 0;
  for (const Stick& stick : sticks) most = std::max(most, stick.height);
  if (!(most > 0)) return;
  const double scale = double(kStick * s.diagonal_m / most);
  for (const Stick& stick : sticks)
    out.push_back({to_float(stick.foot),
                   to_float(stick.foot + stick.normal * (scale * double(stick.height))), color});
}

DVec3 normal_of(const h::Solution& s, const h::LightTriangle& t) {
  return s.faces.faces[t.face].plane.normal;
}

void add_error(const h::Solution& s, const h::LightMesh& mesh, std::span<const float> error,
               Lines& out) {
  std::vector<Stick> sticks;
  for (size_t k = 0; k < mesh.triangles.size(); ++k) {
    const h::LightTriangle& t = mesh.triangles[k];
    sticks.push_back({h::middle_of(mesh, t), normal_of(s, t), error[k]});
  }
  add_sticks(s, sticks, kRed, out);
}

void add_samples(const h::Solution& s, const h::LightMesh& mesh, Lines& out) {
  std::vector<Stick> sticks;
  for (size_t k = 0; k < mesh.triangles.size(); ++k) {
    const h::LightTriangle& t = mesh.triangles[k];
    const h::Interpolant& r = mesh.interpolant[k];
    const std::array<Rgb, 3> e{h::value_of(r, 0, 0), h::value_of(r, 1, 0), h::value_of(r, 0, 1)};
    for (size_t c = 0; c < 3; ++c)
      sticks.push_back({mesh.vertices[t.vertex[c]], normal_of(s, t), luminance(e[c])});
  }
  add_sticks(s, sticks, kYellow, out);
}

}  // namespace

std::string overlay_names() {
  std::string names;
  for (const std::string_view name : kNames)
    names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

Result<std::vector<std::string>> parse_overlays(std::string_view text) {
  std::vector<std::string> out;
  if (text.empty()) return out;
  for (const std::string_view name : split_at_commas(text)) {
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end())
      return fail(ErrorCode::bad_setting, "--overlay {} is not known; there is: {}", name,
                  overlay_names());
    out.emplace_back(name);
  }
  return out;
}

bool overlay_needs_mesh(std::span<const std::string> names) {
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "triangulation" || name == "error" || name == "samples";
  });
}

Result<std::vector<display::Line>> overlay_lines(std::span<const std::string> names,
                                                 const h::Solution& s, const h::LightMesh& mesh,
                                                 const scene::Scene& scene,
                                                 const trace::RayTracer& tracer,
                                                 const h::MeshParams& params, Progress& progress) {
  Lines out;
  const auto wants = [&](std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (wants("mesh")) add_mesh(s, out);
  if (wants("links")) add_links(s, tracer, out);
  if (wants("discontinuities")) add_discontinuities(s, scene, tracer, params.discontinuity, out);
  if (wants("triangulation")) add_triangulation(mesh, out);
  if (wants("samples")) add_samples(s, mesh, out);
  if (wants("error")) {
    LUXEL_TRY(const std::vector<float> error,
              h::measure_error(s, scene, tracer, params.point, mesh, progress));
    add_error(s, mesh, error, out);
  }
  return out;
}

}  // namespace luxel::pipeline
