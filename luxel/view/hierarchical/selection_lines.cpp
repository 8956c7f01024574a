// Numbers of what is selected as lines of a panel.
#include <cmath>

#include "luxel/view/hierarchical/selection_facts.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

std::string place_text(DVec3 p) { return fmt::format("{:.3f} {:.3f} {:.3f}", p.x, p.y, p.z); }

const char* words_of(h::DiscontinuityKind kind) {
  switch (kind) {
    case h::DiscontinuityKind::ve:
      return "VE: a corner of the source past an edge of the blocker";
    case h::DiscontinuityKind::ev:
      return "EV: an edge of the source past a corner of the blocker";
    case h::DiscontinuityKind::horizon:
      return "horizon: the source's plane cuts the receiver";
    case h::DiscontinuityKind::contact:
      return "contact: another face stands on the receiver";
  }
  return "";
}

const char* words_of_degree(int degree) {
  if (degree == 0) return "D0: light jumps";
  return degree == 1 ? "D1: its slope jumps" : "D2: its curvature jumps";
}

std::string generator_text(const Generator& part, DVec3 origin) {
  const std::string from = place_text(part.from + origin);
  return part.is_edge() ? fmt::format("edge {} to {}", from, place_text(part.to + origin))
                        : fmt::format("corner {}", from);
}

}  // namespace

std::string text_of(Rgb light, const std::string& unit) {
  const std::string after = unit.empty() ? "" : " " + unit;
  if (light.x == light.y && light.y == light.z) return fmt::format("{:.4g}{}", light.x, after);
  return fmt::format("{:.3g}, {:.3g}, {:.3g}{}", light.x, light.y, light.z, after);
}

std::vector<std::string> lines_of(const NodeFacts& f, const std::string& unit) {
  std::vector<std::string> out;
  if (f.is_cluster) {
    out.push_back(fmt::format("cluster {}, {} above it", f.id, f.depth));
    out.push_back(fmt::format("{} elements of faces below, {:.4g} m2", f.leaves, f.area_m2));
  } else {
    out.push_back(f.name);
    out.push_back(f.height == 0
                      ? fmt::format("a leaf at depth {}, {:.4g} m2", f.depth, f.area_m2)
                      : fmt::format("depth {}, {} divisions and {} leaves below it; {:.4g} m2",
                                    f.depth, f.height, f.leaves, f.area_m2));
    out.push_back("E " + text_of(f.irradiance, unit));
  }
  out.push_back("B " + text_of(f.radiosity, unit));
  if (!f.is_cluster) out.push_back("reflectance " + text_of(f.reflectance, ""));
  out.push_back(fmt::format("{} links end here, {} above it", f.links, f.links_above));
  if (f.links == 0) return out;
  if (!f.is_cluster) out.push_back("they bring E " + text_of(f.over_links, unit));
  out.push_back(fmt::format("their errors: {:.3g} at most, {:.3g} in all; eps {:.3g} {}",
                            f.most_error, f.sum_of_errors, f.eps, unit));
  if (f.over_eps > 0) out.push_back(fmt::format("{} of them err by more than eps", f.over_eps));
  return out;
}

std::vector<std::string> lines_of(const LinkFacts& f, const std::string& unit) {
  std::vector<std::string> out{"from " + f.source, "to " + f.receiver};
  out.push_back(fmt::format("{:.3g} m from middle to middle", f.distance_m));
  out.push_back(f.is_far ? fmt::format("{:.4g} of E per W sent, 1/m2", f.form_factor)
                         : fmt::format("form factor {:.4g}", f.form_factor));
  out.push_back(fmt::format("visible {:.4g} %", 100 * f.visible));
  out.push_back("brings E " + text_of(f.irradiance, unit));
  out.push_back(fmt::format("error {:.3g}, eps {:.3g} {}: {}", f.error, f.eps, unit,
                            f.error > f.eps ? "as small as it may be" : "good enough"));
  if (f.is_far)
    out.push_back("to or from a cluster: it has no shaft");
  else if (f.is_crowded)
    out.push_back(fmt::format("{} faces in its shaft: rays decide", f.blockers.size()));
  else
    out.push_back(fmt::format("{} {} in its shaft", f.blockers.size(),
                              f.blockers.size() == 1 ? "face" : "faces"));
  return out;
}

std::vector<std::string> lines_of(const TriangleFacts& f, const std::string& unit, DVec3 origin) {
  std::vector<std::string> out{fmt::format("{:.4g} m2 of element {}", f.area_m2, f.leaf)};
  for (size_t k = 0; k < 3; ++k)
    out.push_back(
        fmt::format("{}: E {}", place_text(f.corner[k] + origin), text_of(f.value[2 * k], unit)));
  for (size_t k = 0; k < 3; ++k)
    out.push_back(fmt::format("middle of edge {}: E {}", k + 1, text_of(f.value[2 * k + 1], unit)));
  out.push_back(fmt::format("up to {:.3g} {} from linear", f.bend, unit));
  out.push_back(fmt::format("{} of its edges lie on discontinuities", f.line_edges));
  return out;
}

std::vector<std::string> lines_of(const DiscontinuityFacts& f, const std::string& unit,
                                  DVec3 origin) {
  std::vector<std::string> out{words_of(f.line.kind), words_of_degree(f.degree)};
  out.push_back(fmt::format("{:.3g} m long", length(f.line.b - f.line.a)));
  const char* per = f.ranking == h::Ranking::slope ? " per m" : "";
  out.push_back(std::isinf(f.weight) ? std::string("weight: above all others")
                                     : fmt::format("weight {:.3g} {}{}", f.weight, unit, per));
  if (!f.source.empty()) out.push_back("source " + f.source);
  if (f.at_source) out.push_back("  " + generator_text(*f.at_source, origin));
  if (!f.blocker.empty()) out.push_back("blocker " + f.blocker);
  if (f.at_blocker) out.push_back("  " + generator_text(*f.at_blocker, origin));
  return out;
}

}  // namespace luxel::view
