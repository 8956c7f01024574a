// Lengths of glTF buffers: stated, and there.
#include <gmock/gmock.h>

#include <algorithm>
#include <span>

#include "luxel/base/base64.h"
#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

/// The square in a .gltf file whose only buffer holds `more` bytes after those that it states, in
/// the text or in a file.
Result<Imported> square_with_bytes(int more, bool in_file) {
  const Gltf gltf = square_gltf();
  const std::string stated = gltf.buffer;
  std::string bytes = stated.substr(0, size_t(int(stated.size()) + std::min(more, 0)));
  bytes.append(size_t(std::max(more, 0)), '\0');
  const TemporaryFolder folder;
  folder.write("its bytes.bin", bytes);
  nlohmann::json document = gltf.json;
  document["buffers"] = {{{"byteLength", stated.size()},
                          {"uri", in_file ? "its%20bytes.bin"
                                          : "data:application/octet-stream;base64," +
                                                base64(std::as_bytes(std::span(bytes)))}}};
  return import_scene(folder.write("a.gltf", document.dump()));
}

TEST(Gltf, ABufferMayBeLongerThanItStates) {
  for (const bool in_file : {false, true}) {
    for (const int more : {0, 1, 2, 3, 4, 150000})
      EXPECT_NEAR(drawn_area(scene_of(square_with_bytes(more, in_file))), 1, 1e-6f) << more;
    for (const int less : {-1, -40}) {
      const auto imported = square_with_bytes(less, in_file);
      ASSERT_FALSE(imported) << less;
      EXPECT_THAT(imported.error().message, HasSubstr("buffer 0 has fewer bytes than"));
    }
  }
}

// A buffer that no view names is read all the same, and its length compared with what it states.
TEST(Gltf, EveryBufferStatesItsLength) {
  const auto error_with = [](const nlohmann::json& second_buffer) {
    const Gltf gltf = square_gltf();
    nlohmann::json document = gltf.json;
    const std::string uri = "data:application/octet-stream;base64,";
    document["buffers"] = {
        {{"byteLength", gltf.buffer.size()},
         {"uri", uri + base64(std::as_bytes(std::span(gltf.buffer.data(), gltf.buffer.size())))}},
        {{"uri", uri + "AAAA"}}};
    document["buffers"][1].update(second_buffer);
    const TemporaryFolder folder;
    const auto imported = import_scene(folder.write("a.gltf", document.dump()));
    return imported ? "no error" : imported.error().message;
  };
  EXPECT_EQ(error_with({{"byteLength", 3}}), "no error");
  EXPECT_THAT(error_with(nlohmann::json::object()), HasSubstr("buffer 1: it has no byteLength"));
  EXPECT_THAT(error_with({{"byteLength", "three"}}),
              HasSubstr("buffers/1/byteLength is \"three\", must be a whole number from 0 on"));
}

}  // namespace
}  // namespace luxel::import
