// A reader of .glb for tests of what export writes, by the text of the glTF 2.0 specification.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::export_ {

using nlohmann::json;

struct Document {
  json j;
  std::vector<std::byte> binary;
};

inline uint32_t u32_at(std::span<const std::byte> bytes, size_t at) {
  uint32_t v;
  std::memcpy(&v, bytes.data() + at, 4);
  return v;
}

inline Document parse(std::span<const std::byte> glb) {
  EXPECT_EQ(u32_at(glb, 0), 0x46546C67u);
  EXPECT_EQ(u32_at(glb, 4), 2u);
  EXPECT_EQ(u32_at(glb, 8), glb.size());
  const size_t json_size = u32_at(glb, 12);
  EXPECT_EQ(u32_at(glb, 16), 0x4E4F534Au);
  EXPECT_EQ(json_size % 4, 0u);
  const char* text = reinterpret_cast<const char*>(glb.data()) + 20;
  Document document{json::parse(text, text + json_size), {}};
  const size_t rest = 20 + json_size;
  if (rest < glb.size()) {
    EXPECT_EQ(u32_at(glb, rest + 4), 0x004E4942u);
    EXPECT_EQ(u32_at(glb, rest), glb.size() - rest - 8);
    document.binary.assign(glb.begin() + std::ptrdiff_t(rest) + 8, glb.end());
  }
  return document;
}

inline std::vector<float> floats(const Document& d, const json& accessor) {
  const json& view = d.j["bufferViews"][accessor["bufferView"].get<size_t>()];
  const std::string type = accessor["type"];
  const size_t components = type == "SCALAR" ? 1 : type.back() - '0';  // VEC2
  std::vector<float> out(accessor["count"].get<size_t>() * components);
  EXPECT_EQ(accessor["componentType"], 5126);
  EXPECT_EQ(view["byteLength"], out.size() * 4);
  std::memcpy(out.data(), d.binary.data() + view["byteOffset"].get<size_t>(), out.size() * 4);
  return out;
}

inline void expect_close(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_LE(length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " for " << b.x << " " << b.y << " " << b.z;
}

template <class T>
std::vector<T> vectors(const Document& d, const json& attributes, const char* name) {
  const std::vector<float> raw = floats(d, d.j["accessors"][attributes[name].get<size_t>()]);
  std::vector<T> out(raw.size() * sizeof(float) / sizeof(T));
  std::memcpy(static_cast<void*>(out.data()), raw.data(), raw.size() * sizeof(float));
  return out;
}

inline std::vector<uint32_t> indices(const Document& d, const json& primitive) {
  const json& accessor = d.j["accessors"][primitive["indices"].get<size_t>()];
  const json& view = d.j["bufferViews"][accessor["bufferView"].get<size_t>()];
  const std::byte* at = d.binary.data() + view["byteOffset"].get<size_t>();
  std::vector<uint32_t> out(accessor["count"].get<size_t>());
  for (size_t i = 0; i < out.size(); ++i)
    if (accessor["componentType"] == 5123) {
      uint16_t v;
      std::memcpy(&v, at + 2 * i, 2);
      out[i] = v;
    } else {
      std::memcpy(&out[i], at + 4 * i, 4);
    }
  return out;
}

inline Mat34 rotation(const json& q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  Mat34 m;
  m.row[0] = {float(1 - 2 * (y * y + z * z)), float(2 * (x * y - z * w)),
              float(2 * (x * z + y * w)), 0};
  m.row[1] = {float(2 * (x * y + z * w)), float(1 - 2 * (x * x + z * z)),
              float(2 * (y * z - x * w)), 0};
  m.row[2] = {float(2 * (x * z - y * w)), float(2 * (y * z + x * w)),
              float(1 - 2 * (x * x + y * y)), 0};
  return m;
}

inline Mat34 local_matrix(const json& node) {
  Mat34 m;
  if (node.contains("matrix")) {
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 4; ++j) m.row[i][j] = node["matrix"][4 * j + i];
    return m;
  }
  if (node.contains("scale")) m = scaling({node["scale"][0], node["scale"][1], node["scale"][2]});
  if (node.contains("rotation")) m = rotation(node["rotation"]) * m;
  if (node.contains("translation"))
    m = translation({node["translation"][0], node["translation"][1], node["translation"][2]}) * m;
  return m;
}

struct Corner {
  Vec3 position, normal, color;
  Vec2 uv0, uv1;
};
struct ReadTriangle {
  std::array<Corner, 3> corner;
  json material;
  std::string node;
};

inline void read_primitive(const Document& d, const json& primitive, const Mat34& world,
                           const std::string& name, std::vector<ReadTriangle>& out) {
  const json& attributes = primitive["attributes"];
  const auto positions = vectors<Vec3>(d, attributes, "POSITION");
  std::vector<Vec3> normals, colors;
  std::vector<Vec2> uv0, uv1;
  if (attributes.contains("NORMAL")) normals = vectors<Vec3>(d, attributes, "NORMAL");
  if (attributes.contains("COLOR_0")) colors = vectors<Vec3>(d, attributes, "COLOR_0");
  if (attributes.contains("TEXCOORD_0")) uv0 = vectors<Vec2>(d, attributes, "TEXCOORD_0");
  if (attributes.contains("TEXCOORD_1")) uv1 = vectors<Vec2>(d, attributes, "TEXCOORD_1");
  const auto index = indices(d, primitive);
  for (size_t i = 0; i < index.size(); i += 3) {
    ReadTriangle triangle;
    triangle.material = d.j["materials"][primitive["material"].get<size_t>()];
    triangle.node = name;
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t v = index[i + c];
      triangle.corner[c].position = transform_point(world, positions[v]);
      if (!normals.empty()) triangle.corner[c].normal = normals[v];
      if (!colors.empty()) triangle.corner[c].color = colors[v];
      if (!uv0.empty()) triangle.corner[c].uv0 = uv0[v];
      if (!uv1.empty()) triangle.corner[c].uv1 = uv1[v];
    }
    out.push_back(triangle);
  }
}

inline void read_node(const Document& d, size_t index, const Mat34& parent,
                      std::vector<ReadTriangle>& out) {
  const json& node = d.j["nodes"][index];
  const Mat34 world = parent * local_matrix(node);
  if (node.contains("mesh"))
    for (const json& primitive : d.j["meshes"][node["mesh"].get<size_t>()]["primitives"])
      read_primitive(d, primitive, world, node.value("name", ""), out);
  if (node.contains("children"))
    for (const json& child : node["children"]) read_node(d, child.get<size_t>(), world, out);
}

inline std::vector<ReadTriangle> read_triangles(const Document& d) {
  std::vector<ReadTriangle> out;
  for (const json& root : d.j["scenes"][0]["nodes"]) read_node(d, root.get<size_t>(), {}, out);
  return out;
}

}  // namespace luxel::export_
