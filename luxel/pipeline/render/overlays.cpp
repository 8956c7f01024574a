#include "luxel/pipeline/render/overlays.h"

#include <algorithm>
#include <array>

#include "luxel/base/parallel.h"
#include "luxel/pipeline/settings/comma_list.h"

namespace luxel::pipeline {
namespace {

namespace h = luxel::hierarchical;
using Lines = std::vector<display::Line>;

constexpr Rgb kGrey{0.25f, 0.25f, 0.25f}, kWhite{1, 1, 1}, kPink{1, 0.5f, 0.7f},
    kGreen{0.1f, 0.7f, 0.2f}, kViolet{0.55f, 0.1f, 0.85f}, kRed{0.9f, 0.1f, 0.1f},
    kYellow{0.95f, 0.85f, 0.1f};
constexpr float kStick = 0.05f;  ///< of the diagonal

constexpr std::array<std::string_view, 6> kNames{"mesh",          "links", "discontinuities",
                                                 "triangulation", "error", "samples"};

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

struct Stick {
  DVec3 foot;
  DVec3 normal;
  float height;
};

Lines lines_of(const h::Solution& s, const std::vector<Stick>& sticks, Rgb color) {
  float most = 0;
  for (const Stick& stick : sticks) most = std::max(most, stick.height);
  Lines out;
  if (!(most > 0)) return out;
  const double scale = double(kStick * s.diagonal_m / most);
  for (const Stick& stick : sticks)
    out.push_back({to_float(stick.foot),
                   to_float(stick.foot + stick.normal * (scale * double(stick.height))), color});
  return out;
}

DVec3 normal_of(const h::Solution& s, const h::LightTriangle& t) {
  return s.faces.faces[t.face].plane.normal;
}

void add(Lines more, Lines& out) { out.insert(out.end(), more.begin(), more.end()); }

}  // namespace

Lines mesh_lines(const h::Solution& s, int depth) {
  Lines out;
  std::vector<int> depth_of(s.tree.elements.size());
  for (size_t i = 0; i < s.tree.elements.size(); ++i) {
    const h::Element& e = s.tree.elements[i];
    if (!e.is_leaf()) std::fill_n(depth_of.begin() + std::ptrdiff_t(e.child), 4, depth_of[i] + 1);
    if (depth_of[i] > depth || (!e.is_leaf() && depth_of[i] < depth)) continue;
    for (uint32_t k = 0; k < e.corners; ++k)
      out.push_back({to_float(e.corner[k]), to_float(e.corner[(k + 1) % e.corners]), kGrey});
  }
  return out;
}

std::vector<StrongLink> strong_links(const h::Solution& s, const trace::RayTracer& tracer,
                                     const LinkChoice& choice) {
  std::vector<StrongLink> out;
  const h::Exchange x = s.exchange(tracer);
  for (uint32_t id = uint32_t(s.tree.clusters.size()); id < s.tree.size(); ++id)
    for (uint32_t k = 0; k < s.links.of[id].size(); ++k) {
      const h::Link& link = s.links.of[id][k];
      if (s.tree.is_cluster(link.source)) continue;
      if (!(link.visible < 1 ? choice.partial : choice.whole)) continue;
      out.push_back(
          {id, k,
           s.tree.element(id).area_m2 * double(luminance(h::irradiance_of(link, x, s.light)))});
    }
  std::stable_sort(out.begin(), out.end(),
                   [](const StrongLink& a, const StrongLink& b) { return a.power_W > b.power_W; });
  out.resize(std::min(choice.most, out.size()));
  return out;
}

void add_arrow(DVec3 from, DVec3 to, double head_m, Rgb color, Lines& out) {
  out.push_back({to_float(to), to_float(from), color});
  const double length_m = length(from - to);
  if (!(length_m > 0)) return;
  const DVec3 back = normalize(from - to);
  const DVec3 aside =
      normalize(cross(back, std::abs(back.y) < 0.9 ? DVec3{0, 1, 0} : DVec3{1, 0, 0}));
  const double head = std::min(head_m, 0.3 * length_m);
  for (const double side : {-0.4, 0.4})
    out.push_back({to_float(to), to_float(to + (back + aside * side) * head), color});
}

Lines link_lines(const h::Solution& s, std::span<const StrongLink> links) {
  Lines out;
  for (const StrongLink& strong : links) {
    const h::Link& link = s.links.of[strong.receiver][strong.number];
    const h::Element &r = s.tree.element(strong.receiver), &e = s.tree.element(link.source);
    add_arrow(e.centre, r.centre, kArrowHead * double(s.diagonal_m), color_of(s, r, e, link), out);
  }
  return out;
}

Result<std::vector<h::Discontinuity>> all_discontinuities(const h::Solution& s,
                                                          const scene::Scene& scene,
                                                          const trace::RayTracer& tracer,
                                                          h::DiscontinuityParams params,
                                                          Progress& progress) {
  params.least_weight = 0;
  const h::DiscontinuityLimits limits = h::limits_of(s, params);
  std::vector<std::vector<h::Discontinuity>> of_face(s.faces.size());
  progress.begin("discontinuities", of_face.size());
  parallel_for(of_face.size(), 1, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end && !progress.cancelled(); ++f)
      of_face[f] = h::find_discontinuities(s, scene, tracer, uint32_t(f), params.ranking, limits);
    progress.advance(end - begin);
  });
  LUXEL_TRY_STATUS(stopped(progress));
  std::vector<h::Discontinuity> out;
  for (const auto& some : of_face) out.insert(out.end(), some.begin(), some.end());
  return out;
}

Lines discontinuity_lines(std::span<const h::Discontinuity> discontinuities) {
  Lines out;
  for (const h::Discontinuity& d : discontinuities)
    out.push_back({to_float(d.a), to_float(d.b), kViolet});
  return out;
}

Lines triangulation_lines(const h::LightMesh& mesh) {
  Lines out;
  for (const h::LightTriangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k)
      out.push_back({to_float(mesh.vertices[t.vertex[k]]),
                     to_float(mesh.vertices[t.vertex[(k + 1) % 3]]),
                     t.edge_is_line[k] ? kViolet : kGreen});
  return out;
}

Lines error_lines(const h::Solution& s, const h::LightMesh& mesh, std::span<const float> error) {
  std::vector<Stick> sticks;
  for (size_t k = 0; k < mesh.triangles.size(); ++k) {
    const h::LightTriangle& t = mesh.triangles[k];
    sticks.push_back({h::middle_of(mesh, t), normal_of(s, t), error[k]});
  }
  return lines_of(s, sticks, kRed);
}

Lines sample_lines(const h::Solution& s, const h::LightMesh& mesh) {
  std::vector<Stick> sticks;
  for (size_t k = 0; k < mesh.triangles.size(); ++k) {
    const h::LightTriangle& t = mesh.triangles[k];
    const h::Interpolant& r = mesh.interpolant[k];
    const std::array<Rgb, 3> e{h::value_of(r, 0, 0), h::value_of(r, 1, 0), h::value_of(r, 0, 1)};
    for (size_t c = 0; c < 3; ++c)
      sticks.push_back({mesh.vertices[t.vertex[c]], normal_of(s, t), luminance(e[c])});
  }
  return lines_of(s, sticks, kYellow);
}

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
      return fail(ErrorCode::bad_setting, "--overlay {} is not known; choose from: {}", name,
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
  if (wants("mesh")) add(mesh_lines(s), out);
  if (wants("links")) add(link_lines(s, strong_links(s, tracer)), out);
  if (wants("discontinuities")) {
    LUXEL_TRY(const std::vector<h::Discontinuity> found,
              all_discontinuities(s, scene, tracer, params.discontinuity, progress));
    add(discontinuity_lines(found), out);
  }
  if (wants("triangulation")) add(triangulation_lines(mesh), out);
  if (wants("samples")) add(sample_lines(s, mesh), out);
  if (wants("error")) {
    LUXEL_TRY(const std::vector<float> error,
              h::measure_error(s, scene, tracer, params.point, mesh, progress));
    add(error_lines(s, mesh, error), out);
  }
  return out;
}

}  // namespace luxel::pipeline
