// Probes as lines of a panel.
#include "luxel/view/hierarchical/probe.h"
#include "luxel/view/hierarchical/selection_facts.h"

namespace luxel::view {
namespace {

/// So many sources have a line; the others are summed.
constexpr size_t kSourceLines = 8;
/// Less than this part of the light is what is left by rounding.
constexpr float kRounding = 1e-4f;

std::string source_text(const SourceShare& source, const std::string& unit) {
  return fmt::format("{:5.1f} %  {}: {}, {:.3g} % seen", 100 * source.share, source.name,
                     text_of(source.irradiance, unit), 100 * source.visible);
}

}  // namespace

std::vector<std::string> lines_of(const LightProbe& probe, const std::string& unit, DVec3 origin) {
  const DVec3 p = probe.at.position + origin;
  std::vector<std::string> out{fmt::format("{:.3f} {:.3f} {:.3f} on {}", p.x, p.y, p.z, probe.name),
                               "exact E " + text_of(probe.exact, unit),
                               "as shown " + text_of(probe.interpolated, unit),
                               fmt::format("difference {:+.3g} %", 100 * probe.difference)};
  double rest = 0;
  for (size_t k = 0; k < probe.sources.size(); ++k) {
    if (k < kSourceLines)
      out.push_back(source_text(probe.sources[k], unit));
    else
      rest += probe.sources[k].share;
  }
  if (probe.sources.size() > kSourceLines)
    out.push_back(
        fmt::format("{:5.1f} %  {} other faces", 100 * rest, probe.sources.size() - kSourceLines));
  if (max_component(probe.from_no_face) > kRounding * max_component(probe.exact))
    out.push_back("from lamps and the sky " + text_of(probe.from_no_face, unit));
  return out;
}

std::vector<std::string> lines_of(const SeenSource& source, const std::string& unit) {
  return {source.of.name,
          fmt::format("{:.2f} % of its area is seen, {:.2f} % of its form factor",
                      100 * source.visible_area, 100 * source.of.visible),
          fmt::format("brings E {}, {:.1f} % of all", text_of(source.of.irradiance, unit),
                      100 * source.of.share)};
}

}  // namespace luxel::view
