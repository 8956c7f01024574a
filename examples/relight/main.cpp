// A program that relights a scene: a lamp goes round in it, and all bounces follow.
//
//     luxel relight scenes/cornell-box.glb -o box.lxr
//     relight_example box.lxr 100
//
// Two threads, as in a game: one moves the lamp, the other, which would draw, reads the last result
// whenever it likes. Neither waits for the other.
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "luxel/base/shown_text.h"
#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/relighter.h"

using namespace luxel;

/// Errors say in a sentence why the file cannot be used.
static Result<matrix::Relighter> open_lxr(const char* path) {
  LUXEL_TRY(matrix::RelightData data, matrix::read_lxr(path));
  return matrix::Relighter::make(std::move(data), {});
}

/// Mean irradiance of all surfaces after all bounces [W/m^2]: what a renderer would draw with.
static float mean_irradiance(const matrix::Relit& relit, const matrix::RelightData& data) {
  float light = 0, area_m2 = 0;
  for (size_t i = 0; i < data.size(); ++i)
    light += luminance(relit.direct[i] + relit.indirect[i]) * data.area_m2[i],
        area_m2 += data.area_m2[i];
  return light / area_m2;
}

/// `turns` times round the middle of the scene, at three quarters of its height.
static Vec3 on_circle(const Box3& bounds, float turns) {
  const Vec3 size = bounds.upper - bounds.lower;
  const float angle = 2 * kPi * turns, radius_m = 0.25f * std::min(size.x, size.z);
  return bounds.centre() +
         Vec3{radius_m * std::cos(angle), 0.25f * size.y, radius_m * std::sin(angle)};
}

int main(int argc, char** argv) {
  if (argc < 2)
    return std::fprintf(stderr, "give a file made by: luxel relight SCENE -o FILE.lxr\n"), 2;
  const int updates = argc > 2 ? std::max(1, std::atoi(argv[2])) : 60;
  Result<matrix::Relighter> opened = open_lxr(argv[1]);
  if (!opened)
    return std::fprintf(stderr, "%s\n", luxel::short_message(opened.error().message).c_str()), 1;
  matrix::Relighter& relighter = *opened;

  // The thread that would draw.
  std::atomic<bool> over{false};
  std::atomic<float> seen_light{0};
  int seen = 0;
  std::thread reader([&] {
    for (uint64_t last = 0; !over || relighter.latest().update > last; std::this_thread::yield()) {
      const matrix::Relit& now = relighter.latest();
      if (now.update == last) continue;
      ++seen, last = now.update;
      seen_light = mean_irradiance(now, relighter.data());
    }
  });

  // This one moves the lamp. No update allocates.
  Box3 bounds;
  for (const Vec3 p : relighter.data().occluders.position) bounds.extend(p);
  scene::PunctualLight lamp;
  lamp.intensity = Rgb{1, 0.9f, 0.8f} * (bounds.diagonal() * bounds.diagonal());
  for (int k = 0; k < updates; ++k) {
    lamp.position = on_circle(bounds, float(k) / float(updates));
    relighter.update({.punctual = {&lamp, 1}});
    std::printf("update %d: %.3f ms, read: %.4g W/m^2\n", k + 1, 1e3 * relighter.seconds().total(),
                double(seen_light));
  }
  over = true;
  reader.join();
  std::printf("%d of %d results read, the last: %.4g W/m^2\n", seen, updates, double(seen_light));
}
