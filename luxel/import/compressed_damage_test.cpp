// Compressed files that were damaged in every place. The result may be either; what counts is that
// there is one, that its error is a sentence, and that no decoder reads or writes past its memory
// (which the sanitizers see for ours, and for theirs where a block is copied).
#include <gmock/gmock.h>

#include "luxel/import/compressed_test_support.h"

namespace luxel::import {
namespace {

/// Reads the file with everything checked that a caller relies on; whether it could be read.
bool survives(const std::string& glb) {
  const auto* first = reinterpret_cast<const std::byte*>(glb.data());
  const auto imported = import_glb({first, first + glb.size()}, "damaged.glb");
  if (!imported) {
    EXPECT_THAT(imported.error().message, ::testing::StartsWith("damaged.glb: "));
    EXPECT_EQ(imported.error().message.find('\n'), std::string::npos);
    return false;
  }
  for (const scene::Mesh& mesh : imported->scene.meshes) {
    for (const auto& triangle : mesh.triangles)
      for (const uint32_t corner : triangle) EXPECT_LT(corner, mesh.positions.size());
    for (const Vec3 p : mesh.positions)
      EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  }
  return true;
}

struct Damage {
  size_t read = 0, refused = 0;
  void count(bool was_read) { ++(was_read ? read : refused); }
};

/// Flips bits of the bytes of the BIN chunk, one after another.
Damage damage_everywhere(const std::string& glb) {
  Damage damage;
  for (size_t at = 28 + *reinterpret_cast<const uint32_t*>(&glb[12]); at < glb.size(); ++at)
    for (const uint8_t bits : {0x01, 0xff}) {
      std::string bad = glb;
      bad[at] = char(uint8_t(bad[at]) ^ bits);
      damage.count(survives(bad));
    }
  return damage;
}

TEST(CompressedDamage, DracoByEdgebreakerAndInOrder) {
  for (const bool sequential : {false, true})
    for (const int speed : {0, 7}) {
      DracoOptions options;
      options.sequential = sequential;
      options.speed = speed;
      const Gltf gltf = draco_gltf(draco_bytes(torus(3), options));
      ASSERT_TRUE(survives(gltf.glb()));
      EXPECT_GT(damage_everywhere(gltf.glb()).refused, 20u)
          << "the header alone has ten bytes that matter";
      for (size_t length = 0; length < gltf.buffer.size(); length += 1 + length / 16) {
        Gltf cut = gltf;
        cut.json["bufferViews"][0]["byteLength"] = length;
        EXPECT_FALSE(survives(cut.glb())) << length << " of " << gltf.buffer.size();
      }
    }
}

class MeshoptDamage : public ::testing::TestWithParam<const char*> {};

TEST_P(MeshoptDamage, InEveryMode) {
  const Surface surface = torus(3);
  MeshoptGltf m = meshopt_gltf(surface, GetParam());
  const size_t n = surface.vertices();
  std::vector<uint32_t> words(3 * n);
  meshopt_encodeFilterExp(words.data(), n, 12, 15, surface.positions.data());
  const int p = m.accessor(m.attributes(words, 12, "EXPONENTIAL"), 5126, n, "VEC3");
  const int i = m.accessor(m.indices({0, 5, 6, 6, 1, 0}, 2, false), 5123, 6, "SCALAR");
  m.gltf.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", p}}}, {"indices", i}});
  ASSERT_TRUE(survives(m.glb()));
  EXPECT_GT(damage_everywhere(m.glb()).refused, 10u) << "the first byte of each of six views";
  for (size_t view = 0; view < m.gltf.json["bufferViews"].size(); ++view)
    for (size_t length = 0;; length += 1 + length / 16) {
      MeshoptGltf cut = m;
      auto& extension = cut.gltf.json["bufferViews"][view]["extensions"][m.name];
      if (length >= extension["byteLength"]) break;
      extension["byteLength"] = length;
      EXPECT_FALSE(survives(cut.glb())) << "view " << view << ", " << length;
    }
}

INSTANTIATE_TEST_SUITE_P(Extensions, MeshoptDamage,
                         ::testing::Values("EXT_meshopt_compression", "KHR_meshopt_compression"),
                         [](const auto& tested) { return std::string(tested.param, 3); });

// Digits of the document are where counts, strides, ids and offsets stand.
TEST(CompressedDamage, NumbersOfTheDocument) {
  for (const std::string& glb :
       {draco_gltf(draco_bytes(torus(3))).glb(), meshopt_gltf(torus(3)).glb()}) {
    const size_t end = 20 + *reinterpret_cast<const uint32_t*>(&glb[12]);
    Damage damage;
    for (size_t at = 20; at < end; ++at) {
      if (glb[at] < '0' || glb[at] > '9') continue;
      for (const char digit : {'0', '1', '9', '-'}) {
        std::string bad = glb;
        bad[at] = digit;
        damage.count(survives(bad));
      }
    }
    // The digit that stands there already is one of four at some places: that file is intact.
    EXPECT_GT(damage.read, 0u);
    EXPECT_GT(damage.refused, (damage.read + damage.refused) / 3);
  }
}

}  // namespace
}  // namespace luxel::import
