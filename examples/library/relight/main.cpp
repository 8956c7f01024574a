// Relights a scene: a lamp goes round in an .lxr file, and all bounces follow.
//
//     luxel relight scenes/cornell-box.glb -o box.lxr
//     relight box.lxr 100
//
// examples/relight does it on two threads, as a game would.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "luxel/base/shown_text.h"
#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/relighter.h"

using namespace luxel;

/// Mean irradiance of all surfaces after all bounces [W/m^2].
static float mean_irradiance(const matrix::Relit& relit, const matrix::RelightData& data) {
  float light = 0, area_m2 = 0;
  for (size_t i = 0; i < data.size(); ++i) {
    light += luminance(relit.direct[i] + relit.indirect[i]) * data.area_m2[i];
    area_m2 += data.area_m2[i];
  }
  return light / area_m2;
}

static Status run(const char* path, int updates) {
  LUXEL_TRY(matrix::RelightData file, matrix::read_lxr(path));
  LUXEL_TRY(matrix::Relighter relighter, matrix::Relighter::make(std::move(file), {}));
  Box3 bounds;
  for (const Vec3 p : relighter.data().occluders.position) bounds.extend(p);
  const Vec3 size = bounds.upper - bounds.lower;
  const float radius_m = 0.25f * std::min(size.x, size.z);

  scene::PunctualLight lamp;
  lamp.intensity = Rgb{1, 0.9f, 0.8f} * (bounds.diagonal() * bounds.diagonal());  // I [W/sr]
  for (int k = 0; k < updates; ++k) {
    const float angle = 2 * kPi * float(k) / float(updates);
    lamp.position = bounds.centre() +
                    Vec3{radius_m * std::cos(angle), 0.25f * size.y, radius_m * std::sin(angle)};
    relighter.update({.punctual = {&lamp, 1}});
    std::printf("update %d: %.3f ms, %.4g W/m^2\n", k + 1, 1e3 * relighter.seconds().total(),
                double(mean_irradiance(relighter.latest(), relighter.data())));
  }
  return {};
}

int main(int argc, char** argv) {
  if (argc < 2)
    return std::fprintf(stderr, "give a file made by: luxel relight SCENE -o FILE.lxr\n"), 2;
  const Status done = run(argv[1], argc > 2 ? std::max(1, std::atoi(argv[2])) : 60);
  if (!done)
    return std::fprintf(stderr, "%s\n", luxel::short_message(done.error().message).c_str()), 1;
}
