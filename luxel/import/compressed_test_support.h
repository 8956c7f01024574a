// Compressed glTF files for this room's tests, made by the libraries' own encoders.
#pragma once

#include <draco/compression/encode.h>
#include <meshoptimizer.h>

#include <cmath>
#include <map>

#include "luxel/import/import_test_support.h"

namespace luxel::import {

/// A surface whose vertices are known in closed form.
struct Surface {
  std::vector<float> positions, normals, uv;
  std::vector<uint32_t> indices;
  size_t vertices() const { return positions.size() / 3; }
};

/// A torus of radii 1 and 0.4 about the y axis, `n` x `n` quads, with a seam where uv is 0 and 1.
inline Surface torus(uint32_t n) {
  Surface s;
  for (uint32_t i = 0; i <= n; ++i)
    for (uint32_t j = 0; j <= n; ++j) {
      const double u = double(i) / n, v = double(j) / n, a = 2 * M_PI * u, b = 2 * M_PI * v;
      const double x = std::cos(a), z = -std::sin(a), r = 1 + 0.4 * std::cos(b);
      for (const double p : {r * x, 0.4 * std::sin(b), r * z}) s.positions.push_back(float(p));
      for (const double m : {std::cos(b) * x, std::sin(b), std::cos(b) * z})
        s.normals.push_back(float(m));
      for (const double t : {u, v}) s.uv.push_back(float(t));
    }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      const uint32_t a = i * (n + 1) + j, b = a + n + 1;
      for (const uint32_t k : {a, b, b + 1, a, b + 1, a + 1}) s.indices.push_back(k);
    }
  return s;
}

struct DracoOptions {
  int position_bits = 12, normal_bits = 9, uv_bits = 10;
  bool sequential = false;
  int speed = 3;
};

inline void add_draco_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type,
                                const std::vector<float>& values, int components) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, uint8_t(components), draco::DT_FLOAT32, false,
                 int64_t(sizeof(float)) * components, 0);
  const uint32_t count = uint32_t(values.size()) / uint32_t(components);
  const int id = mesh.AddAttribute(attribute, true, count);
  for (uint32_t i = 0; i < count; ++i)
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                          &values[i * size_t(components)]);
}

struct DracoBytes {
  std::string bytes;
  size_t vertices = 0, triangles = 0;  ///< as encoded
};

/// Attributes 0, 1 and 2 are positions, normals and uv.
inline DracoBytes draco_bytes(const Surface& surface, const DracoOptions& options = {}) {
  draco::Mesh mesh;
  mesh.set_num_points(uint32_t(surface.vertices()));
  mesh.SetNumFaces(surface.indices.size() / 3);
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    const uint32_t* i = &surface.indices[size_t(3) * f];
    mesh.SetFace(draco::FaceIndex(f),
                 {draco::PointIndex(i[0]), draco::PointIndex(i[1]), draco::PointIndex(i[2])});
  }
  using Attribute = draco::GeometryAttribute;
  add_draco_attribute(mesh, Attribute::POSITION, surface.positions, 3);
  add_draco_attribute(mesh, Attribute::NORMAL, surface.normals, 3);
  add_draco_attribute(mesh, Attribute::TEX_COORD, surface.uv, 2);
  // As exporters do: now vertices on both sides of a seam share their position.
  mesh.DeduplicateAttributeValues();
  mesh.DeduplicatePointIds();
  draco::Encoder encoder;
  encoder.SetSpeedOptions(options.speed, options.speed);
  encoder.SetAttributeQuantization(Attribute::POSITION, options.position_bits);
  encoder.SetAttributeQuantization(Attribute::NORMAL, options.normal_bits);
  encoder.SetAttributeQuantization(Attribute::TEX_COORD, options.uv_bits);
  encoder.SetEncodingMethod(options.sequential ? draco::MESH_SEQUENTIAL_ENCODING
                                               : draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetTrackEncodedProperties(true);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {
      {buffer.data(), buffer.size()}, encoder.num_encoded_points(), encoder.num_encoded_faces()};
}

/// The surface as a file that requires Draco.
inline Gltf draco_gltf(const DracoBytes& encoded) {
  Gltf gltf;
  const int view = gltf.view(encoded.bytes);
  const auto accessor = [&](int type, size_t count, const char* shape) {
    return gltf.accessor({{"componentType", type}, {"count", count}, {"type", shape}});
  };
  const int p = accessor(5126, encoded.vertices, "VEC3"),
            n = accessor(5126, encoded.vertices, "VEC3"),
            t = accessor(5126, encoded.vertices, "VEC2"),
            i = accessor(5125, 3 * encoded.triangles, "SCALAR");
  const nlohmann::json extension = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  gltf.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  gltf.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  gltf.draw({{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", t}}},
             {"indices", i},
             {"extensions", {{"KHR_draco_mesh_compression", extension}}}});
  return gltf;
}

/// Rows as a stream of KHR_meshopt_compression's format 1, every delta a whole byte.
inline std::string meshopt_format_1(const std::string& rows, size_t stride) {
  std::string out = "\xa1", before(stride, '\0');
  const size_t count = rows.size() / stride, most = std::min<size_t>(8192 / stride / 16 * 16, 256);
  for (size_t at = 0; at < count; at += most) {
    out.append(stride / 4, '\xff');
    for (size_t k = 0; k < stride; ++k)
      for (size_t i = at; i < std::min(at + most, count); ++i) {
        const auto delta = uint8_t(rows[i * stride + k] - before[k]);
        out += char(delta < 128 ? 2 * delta : 2 * (255 - delta) + 1);
        before[k] = rows[i * stride + k];
      }
  }
  return out + std::string(std::max<size_t>(24, stride + stride / 4), '\0');
}

/// Adds views that meshopt fills, with a placeholder for their decoded bytes.
struct MeshoptGltf {
  Gltf gltf;
  size_t decoded_bytes = 0;
  const char* name = "EXT_meshopt_compression";  ///< KHR's attributes are of format 1

  /// Returns the view's index.
  int view(const std::string& compressed, size_t stride, size_t count, const char* mode,
           const char* filter = nullptr) {
    const int at = gltf.view(compressed);
    nlohmann::json& view = gltf.json["bufferViews"][size_t(at)];
    nlohmann::json extension = view;
    extension["byteStride"] = stride;
    extension["count"] = count;
    extension["mode"] = mode;
    if (filter != nullptr) extension["filter"] = filter;
    view = {{"buffer", 1},
            {"byteOffset", decoded_bytes},
            {"byteLength", stride * count},
            {"extensions", {{name, extension}}}};
    if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
    decoded_bytes += stride * count;
    return at;
  }
  template <class T>
  int attributes(const std::vector<T>& rows, size_t stride, const char* filter = nullptr) {
    const size_t count = rows.size() * sizeof(T) / stride;
    if (name[0] == 'K')
      return view(meshopt_format_1(bytes_of(rows), stride), stride, count, "ATTRIBUTES", filter);
    std::string bytes(meshopt_encodeVertexBufferBound(count, stride), '\0');
    bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()),
                                            bytes.size(), rows.data(), count, stride));
    return view(bytes, stride, count, "ATTRIBUTES", filter);
  }
  int indices(const std::vector<uint32_t>& list, size_t stride, bool triangles) {
    std::string bytes(triangles ? meshopt_encodeIndexBufferBound(list.size(), 1 << 20)
                                : meshopt_encodeIndexSequenceBound(list.size(), 1 << 20),
                      '\0');
    auto* out = reinterpret_cast<unsigned char*>(bytes.data());
    bytes.resize(triangles
                     ? meshopt_encodeIndexBuffer(out, bytes.size(), list.data(), list.size())
                     : meshopt_encodeIndexSequence(out, bytes.size(), list.data(), list.size()));
    return view(bytes, stride, list.size(), triangles ? "TRIANGLES" : "INDICES");
  }
  int accessor(int its_view, int component_type, size_t count, const char* type,
               bool normalized = false) {
    return gltf.accessor({{"bufferView", its_view},
                          {"componentType", component_type},
                          {"count", count},
                          {"normalized", normalized},
                          {"type", type}});
  }

  /// Buffer 0 holds the compressed bytes; buffer 1 has none, and is marked as fallback or not.
  nlohmann::json buffers(bool marked) const {
    nlohmann::json placeholder = {{"byteLength", decoded_bytes}};
    if (marked) placeholder["extensions"][name]["fallback"] = true;
    return {{{"byteLength", (gltf.buffer.size() + 3) / 4 * 4}}, placeholder};
  }
  std::string glb(bool marked = true) const {
    Gltf whole = gltf;
    whole.json["extensionsRequired"] = {name};
    return whole.glb(buffers(marked));
  }
};

/// Positions as floats, normals as octahedra of 8 bits, indices as triangles.
inline MeshoptGltf meshopt_gltf(const Surface& surface,
                                const char* name = "EXT_meshopt_compression") {
  MeshoptGltf m;
  m.name = name;
  const size_t n = surface.vertices();
  std::vector<float> four(4 * n);
  for (size_t i = 0; i < n; ++i) std::copy_n(&surface.normals[3 * i], 3, &four[4 * i]);
  std::vector<int8_t> octahedra(4 * n);
  meshopt_encodeFilterOct(octahedra.data(), n, 4, 8, four.data());
  const int p = m.accessor(m.attributes(surface.positions, 12), 5126, n, "VEC3");
  const int normals = m.accessor(m.attributes(octahedra, 4, "OCTAHEDRAL"), 5120, n, "VEC3", true);
  const int t = m.accessor(m.attributes(surface.uv, 8), 5126, n, "VEC2");
  const int i =
      m.accessor(m.indices(surface.indices, 4, true), 5125, surface.indices.size(), "SCALAR");
  m.gltf.draw(
      {{"attributes", {{"POSITION", p}, {"NORMAL", normals}, {"TEXCOORD_0", t}}}, {"indices", i}});
  return m;
}

/// Largest errors of decoded values against the originals.
struct Bounds {
  float position, normal, uv;
};

/// Every triangle of the surface is there once, with its front, each corner within the bounds.
/// Encoders reorder vertices and triangles and turn corners round.
inline void expect_surface(const scene::Mesh& mesh, const Surface& surface, const Bounds& bounds) {
  ASSERT_EQ(mesh.triangles.size(), surface.indices.size() / 3);
  const auto vec3 = [](const std::vector<float>& v, uint32_t i) {
    return Vec3{v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  };
  // Encoders change the order of triangles: each is known by its middle.
  std::vector<Vec3> middles;
  for (size_t t = 0; t < surface.indices.size(); t += 3)
    middles.push_back((vec3(surface.positions, surface.indices[t]) +
                       vec3(surface.positions, surface.indices[t + 1]) +
                       vec3(surface.positions, surface.indices[t + 2])) *
                      (1.0f / 3));
  std::vector<int> met(middles.size());
  for (const auto& triangle : mesh.triangles) {
    const Vec3 middle =
        (mesh.positions[triangle[0]] + mesh.positions[triangle[1]] + mesh.positions[triangle[2]]) *
        (1.0f / 3);
    const auto nearest = std::min_element(middles.begin(), middles.end(), [&](Vec3 a, Vec3 b) {
      return length(a - middle) < length(b - middle);
    });
    const size_t t = size_t(nearest - middles.begin());
    ++met[t];
    // They turn triangles, too: the first corner is the nearest.
    const uint32_t* corners = &surface.indices[3 * t];
    size_t turn = 0;
    for (size_t k = 1; k < 3; ++k)
      if (length(vec3(surface.positions, corners[k]) - mesh.positions[triangle[0]]) <
          length(vec3(surface.positions, corners[turn]) - mesh.positions[triangle[0]]))
        turn = k;
    // Every attribute of every corner.
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t from = corners[(k + turn) % 3], to = triangle[k];
      expect_near(mesh.positions[to], vec3(surface.positions, from), bounds.position);
      expect_near(mesh.normals[to], vec3(surface.normals, from), bounds.normal);
      EXPECT_NEAR(mesh.uv0[to].x, surface.uv[2 * from], bounds.uv);
      EXPECT_NEAR(mesh.uv0[to].y, surface.uv[2 * from + 1], bounds.uv);
    }
  }
  EXPECT_EQ(met, std::vector<int>(middles.size(), 1));
}

}  // namespace luxel::import
