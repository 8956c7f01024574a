#include "luxel/view/relight/lamp_check.h"

#include "luxel/base/random.h"

namespace luxel::view {
namespace {

/// Texels are of about one size: by chance, so many of those that patches light.
CheckedTexels texels_to_check(RelitLight& light, const LampCheckParams& params) {
  const matrix::Target& target = light.relighter.data().target;
  const std::vector<Rgb>& indirect = light.relighter.latest().indirect_at_points;
  const std::vector<uint32_t>& lit = light.places.place;
  CheckedTexels out;
  for (size_t k = 0; k < params.places && !lit.empty(); ++k) {
    const uint32_t place = lit[hash64(params.seed, k) % lit.size()];
    out.position.push_back(target.position[place]), out.normal.push_back(target.normal[place]);
    out.geometric_normal.push_back(target.geometric_normal[place]);
    out.indirect.push_back(indirect[place]);
  }
  return out;
}

}  // namespace

LampsToCheck lamps_to_check(OpenedLxr& opened, const Lamps& now, const LampCheckParams& params) {
  relight(now, opened.light);
  return {opened.read,
          texels_to_check(opened.light, params),
          opened.light.relighter.data().bounces,
          opened.lamps,
          now,
          params};
}

Result<pipeline::IndirectError> check_lamps(const LampsToCheck& asked, Progress& progress) {
  scene::Scene scene = asked.read->scene;
  scene.lights = shining(asked.now), scene.background = asked.now.background;
  for (scene::Material& m : scene.materials) m.emission = emission_now(m, asked.now, asked.baked);
  progress.expect(pipeline::stages_of_indirect_error(scene.lights.size()));
  const CheckedTexels& texels = asked.texels;
  return pipeline::indirect_error({scene,
                                   *asked.read->tracer,
                                   {texels.position, texels.normal, texels.geometric_normal, {}},
                                   texels.indirect,
                                   asked.bounces},
                                  asked.params.paths, asked.params.seed, progress);
}

std::unique_ptr<LampCheck> begin_lamp_check() {
  return std::make_unique<LampCheck>(
      [](const LampsToCheck& asked, const LampCheck::Hand& hand, Progress& progress) {
        return check_lamps(asked, progress).map(hand);
      });
}

std::string sentence_of(const pipeline::IndirectError& error, const LampCheckParams& params) {
  if (error.places == 0) return "no texel lies outside solids: there is nothing to compare";
  return fmt::format(
      "light of all bounces at {} texels differs from the path tracer's by {:.1f} % (root mean "
      "square over the mean), at 95 % of them by at most {:.1f} %; {} paths each, which err by "
      "{:.1f} %",
      error.places, 100 * error.rms, 100 * error.p95, 2 * params.paths, 100 * error.noise);
}

}  // namespace luxel::view
