// Shared by the tests of `luxel relight`: small files, and looking at what they play.
#pragma once

#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "tests/command.h"

namespace luxel::testing_support {

inline const std::string kBox = scene_file("cornell-box.glb");
inline const std::string kSmall = " --patches 300 --rays 256 --resolution 32 ";

/// `luxel relight` of the Cornell box.
inline CommandResult make(const std::filesystem::path& lxr, const std::string& options) {
  return luxel("relight " + kBox + kSmall + options + " -o " + lxr.string());
}

/// A lamp goes from the right to the left of the box.
inline constexpr const char* kMoves = R"({"frames": 4, "frames_per_second": 2, "size": [32, 24],
  "lights": [{"position": [{"at": 0, "value": [0.1, 0.45, 0.1]},
                           {"at": 1.5, "value": [0.45, 0.45, 0.1]}], "intensity": [1, 1, 1]}],
  "emission": [{"material": "light", "radiance": [0, 0, 0]}]})";

inline CommandResult play(const std::filesystem::path& lxr, const std::filesystem::path& script,
                          const std::filesystem::path& output, const std::string& options = "") {
  return luxel("relight --play " + lxr.string() + " --script " + script.string() + " -o " +
               output.string() + " " + options);
}

inline image::Image8 picture(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  EXPECT_TRUE(bytes) << path;
  return bytes ? *image::decode_ldr(*bytes, path.string()) : image::Image8{};
}

/// Mean of 0..255 over the columns [from, to) of a picture, all channels.
inline double mean_of(const image::Image8& p, int from, int to) {
  double sum = 0;
  const int channels = int(p.data.size()) / (p.width * p.height);
  for (int y = 0; y < p.height; ++y)
    for (int x = from; x < to; ++x)
      for (int c = 0; c < 3; ++c) sum += p.data[size_t((y * p.width + x) * channels + c)];
  return sum / (3.0 * p.height * (to - from));
}

}  // namespace luxel::testing_support
