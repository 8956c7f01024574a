// Small files for this room's tests, written when they are needed.
#pragma once

#include <gtest/gtest.h>
#include <stb/stb_image_write.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "luxel/import/import.h"

namespace luxel::import {

/// A folder of this test's own, removed with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "luxel-import-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The bytes of values, one after another.
template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

inline void append_to_string(void* text, void* data, int size) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(data), size_t(size));
}
/// A picture of one colour, as a PNG file.
inline std::string png_of(int width, int height, std::array<uint8_t, 4> rgba) {
  std::vector<uint8_t> pixels(4 * size_t(width) * size_t(height));
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = rgba[i % 4];
  std::string png;
  stbi_write_png_to_func(append_to_string, &png, width, height, 4, pixels.data(), 4 * width);
  return png;
}

/// A glTF document in the making: add() puts data into buffer 0 with a view and an accessor.
struct Gltf {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string buffer;

  /// Returns the view's index.
  int view(const std::string& bytes) {
    while (buffer.size() % 4) buffer += '\0';
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    buffer += bytes;
    return int(json["bufferViews"].size()) - 1;
  }
  /// Returns the accessor's index.
  int accessor(nlohmann::json object) {
    json["accessors"].push_back(std::move(object));
    return int(json["accessors"].size()) - 1;
  }
  template <class T>
  int add(const std::vector<T>& values, int component_type, const char* type, int components,
          bool normalized = false) {
    const int its_view = view(bytes_of(values));
    return accessor({{"bufferView", its_view},
                     {"componentType", component_type},
                     {"count", values.size() / size_t(components)},
                     {"normalized", normalized},
                     {"type", type}});
  }
  int floats(const std::vector<float>& values, const char* type, int components) {
    return add(values, 5126, type, components);
  }

  /// A mesh of one primitive, a node that draws it, a scene that holds the node.
  void draw(nlohmann::json primitive) {
    json["meshes"].push_back({{"name", "thing"}, {"primitives", {std::move(primitive)}}});
    node({{"mesh", json["meshes"].size() - 1}});
  }
  void node(nlohmann::json object) {
    json["nodes"].push_back(std::move(object));
    json["scenes"][0]["nodes"].push_back(json["nodes"].size() - 1);
  }

  /// `buffers`: null for the one that add() fills.
  std::string glb(const nlohmann::json& buffers = {}) const {
    nlohmann::json document = json;
    std::string bin = buffer;
    while (bin.size() % 4) bin += '\0';
    if (!buffer.empty()) document["buffers"] = {{{"byteLength", bin.size()}}};
    if (!buffers.is_null()) document["buffers"] = buffers;
    std::string text = document.dump();
    while (text.size() % 4) text += ' ';
    const size_t bin_chunk = bin.empty() ? 0 : 8 + bin.size();
    const auto words = [](std::vector<uint32_t> w) { return bytes_of(w); };
    std::string file = words({0x46546c67, 2, uint32_t(20 + text.size() + bin_chunk),
                              uint32_t(text.size()), 0x4e4f534a}) +
                       text;
    if (bin_chunk) file += words({uint32_t(bin.size()), 0x004e4942}) + bin;
    return file;
  }
};

/// Corners of the unit square in the xy plane, counter-clockwise seen from +z.
inline std::vector<float> square_corners() { return {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}; }

/// The unit square as two triangles.
inline Gltf square_gltf() {
  Gltf gltf;
  const int positions = gltf.floats(square_corners(), "VEC3", 3);
  const int indices = gltf.add<uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 1);
  gltf.draw({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return gltf;
}

inline Result<Imported> import_text(const std::string& name, const std::string& content) {
  const TemporaryFolder folder;
  return import_scene(folder.write(name, content));
}
inline Result<Imported> import_glb(const Gltf& gltf) { return import_text("a.glb", gltf.glb()); }

/// The scene, or a failed test and an empty one.
inline scene::Scene scene_of(const Result<Imported>& imported) {
  EXPECT_TRUE(imported) << imported.error().message;
  return imported ? imported->scene : scene::Scene{};
}

inline std::string all_of(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& w : warnings) text += w + "\n";
  return text;
}

/// The area of all that is drawn.
inline float drawn_area(const scene::Scene& scene) {
  float area = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      area += scene::area_m2(scene::world_triangle(scene, i, t));
  return area;
}

inline void expect_near(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_LE(length(a - b), tolerance) << "(" << a.x << ", " << a.y << ", " << a.z << ") for ("
                                      << b.x << ", " << b.y << ", " << b.z << ")";
}

/// The room that the tests of COLLADA and FBX write in centimetres with z up: a floor, its twin
/// half a metre higher, and a lamp that looks down on them.
inline void expect_room_in_metres(const scene::Scene& scene) {
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[0].name, "floor");
  EXPECT_NEAR(drawn_area(scene), 3, 1e-5f) << "three squares of 100 x 100 cm";
  const scene::SurfacePoint a{0, 0, {0, 0}};
  expect_near(scene::world_position(scene, a), {2, 1, 0}, 1e-5f);
  expect_near(scene::world_position(scene, {0, 0, {0, 1}}), {3, 1, -1}, 1e-5f);
  expect_near(scene::world_position(scene, {1, 0, {0, 1}}), {1, 1.5f, -1}, 1e-5f);
  expect_near(scene::world_position(scene, {2, 0, {0, 1}}), {1, 4, 1}, 1e-5f);
  expect_near(scene::front_normal(scene, 0, 0), {0, 1, 0}, 1e-5f);
  expect_near(scene::front_normal(scene, 2, 0), {0, -1, 0}, 1e-5f);
  expect_near(scene::shading_normal(scene, a), {0, 0.8f, -0.6f}, 1e-5f);
}

/// The message of a failed import: one line that ends without a full stop.
inline std::string error_of(const Result<Imported>& imported) {
  if (imported) return "no error";
  EXPECT_NE(imported.error().message.back(), '.');
  EXPECT_EQ(imported.error().message.find('\n'), std::string::npos);
  return imported.error().message;
}

}  // namespace luxel::import
