// KHR_draco_mesh_compression, by Google's Draco.
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <cstring>
#include <exception>
#include <map>
#include <span>

#include "luxel/import/gltf_check_steps.h"
#include "luxel/import/gltf_load.h"

namespace luxel::import {
namespace {

using DracoBytes = std::span<const unsigned char>;

draco::DecoderBuffer buffer_over(DracoBytes bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return buffer;
}

/// Counts that the stream states, read before anything is allocated for them.
struct Counts {
  uint32_t faces = 0;
  uint32_t vertices = 0;  ///< at most as many as the points that a seamed mesh has
};

/// [Draco bitstream 2.2, sections 3 and 4.1]; glTF asks for this version.
Result<Counts> stated_counts(DracoBytes bytes, const std::string& where) {
  // A mesh of the one version that is known.
  draco::DecoderBuffer buffer = buffer_over(bytes);
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok())
    return fail(ErrorCode::bad_input, "{}: its {} bytes do not start as Draco data do", where,
                bytes.size());
  if (header.version_major != 2 || header.version_minor != 2)
    return fail(ErrorCode::unsupported,
                "{}: it is Draco data of version {}.{}, must be 2.2; export it again", where,
                header.version_major, header.version_minor);
  if (header.encoder_type != draco::TRIANGULAR_MESH)
    return fail(ErrorCode::bad_input, "{}: its Draco data hold points, must be a mesh", where);
  // The counts stand behind the metadata, in an order that the method decides.
  const bool edgebreaker = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING;
  buffer.set_bitstream_version(draco::kDracoMeshBitstreamVersion);
  bool whole = true;
  if (header.flags & METADATA_FLAG_MASK) {
    draco::GeometryMetadata ignored;
    whole = draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &ignored);
  }
  uint8_t traversal = 0;
  if (edgebreaker) whole = whole && buffer.Decode(&traversal);
  uint32_t first = 0, second = 0;
  whole = whole && draco::DecodeVarint(&first, &buffer) && draco::DecodeVarint(&second, &buffer);
  if (!whole)
    return fail(ErrorCode::bad_input, "{}: its {} bytes of Draco data end in their header", where,
                bytes.size());
  return edgebreaker ? Counts{second, first} : Counts{first, second};
}

/// The most triangles that a byte may stand for. A flat grid of 2 x 2047 x 2047 triangles, about
/// the most regular mesh there can be, takes Draco's own encoder 8,289 bytes: 1,011 per byte.
constexpr uint64_t kMostFacesPerByte = 4096;

Result<std::unique_ptr<draco::Mesh>> decode_mesh(DracoBytes bytes, const std::string& where) {
  const auto damaged = [&](const char* reason) {
    return fail(ErrorCode::bad_input, "{}: its {} bytes of Draco data are damaged: {}", where,
                bytes.size(), one_sentence(reason));
  };
  try {
    draco::DecoderBuffer buffer = buffer_over(bytes);
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return damaged(decoded.status().error_msg());
    return std::move(decoded).value();
  } catch (const std::exception& e) {
    return damaged(e.what());
  }
}

/// glTF's number for the type of Draco's components; 0 for those that glTF does not have.
int component_type_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16:
      return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_UINT32:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32:
      return TINYGLTF_COMPONENT_TYPE_FLOAT;
    default:
      return 0;
  }
}

/// One value per point, as the accessor describes it.
Result<std::vector<unsigned char>> values_of(const draco::Mesh& mesh, uint32_t id,
                                             const tinygltf::Accessor& accessor,
                                             const std::string& where) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
  if (attribute == nullptr)
    return fail(ErrorCode::bad_input, "{}: there is no attribute {} in its Draco data", where, id);
  const int components = tinygltf::GetNumComponentsInType(uint32_t(accessor.type));
  if (attribute->num_components() != components ||
      component_type_of(attribute->data_type()) != accessor.componentType)
    return fail(ErrorCode::bad_input,
                "{}: the Draco data hold {} numbers of type {} per vertex, the accessor states {} "
                "of type {}",
                where, attribute->num_components(), component_type_of(attribute->data_type()),
                components, accessor.componentType);
  if (mesh.num_points() != accessor.count)
    return fail(ErrorCode::bad_input, "{}: the Draco data hold {} vertices, the accessor states {}",
                where, mesh.num_points(), accessor.count);
  const size_t size = size_t(components) *
                      size_t(tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType)));
  // Draco's output for damaged data may be inconsistent.
  const size_t rows = size_t(attribute->byte_stride()) == size && attribute->byte_offset() == 0
                          ? attribute->buffer()->data_size() / size
                          : 0;
  const bool mapped =
      attribute->is_mapping_identity() || attribute->indices_map_size() == mesh.num_points();
  std::vector<unsigned char> values(mesh.num_points() * size);
  for (uint32_t i = 0; i < mesh.num_points(); ++i) {
    const size_t row = mapped ? attribute->mapped_index(draco::PointIndex(i)).value() : rows;
    if (row >= rows)
      return fail(ErrorCode::bad_input, "{}: the Draco data have no value for vertex {}", where, i);
    std::memcpy(&values[i * size], attribute->buffer()->data() + row * size, size);
  }
  return values;
}

std::vector<unsigned char> indices_of(const draco::Mesh& mesh) {
  std::vector<unsigned char> bytes(size_t(mesh.num_faces()) * 3 * sizeof(uint32_t));
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t index = face[k].value();
      std::memcpy(&bytes[(3 * f + k) * sizeof index], &index, sizeof index);
    }
  }
  return bytes;
}

/// A new accessor on bytes of its own, packed; the index of it.
int add_accessor(tinygltf::Model& model, tinygltf::Accessor accessor,
                 std::vector<unsigned char> bytes) {
  tinygltf::BufferView view;
  view.buffer = int(model.buffers.size());
  view.byteLength = bytes.size();
  accessor.bufferView = int(model.bufferViews.size());
  accessor.byteOffset = 0;
  accessor.sparse.isSparse = false;
  model.buffers.emplace_back().data = std::move(bytes);
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  return int(model.accessors.size()) - 1;
}

/// Against the accessors: before decoding, because memory is asked for by these counts.
Status check_counts(const Counts& counts, size_t bytes, const tinygltf::Model& model,
                    const Json& primitive, const std::string& where) {
  if (counts.faces > kMostFacesPerByte * bytes)
    return fail(ErrorCode::bad_input, "{}: {} bytes of Draco data cannot hold {} triangles", where,
                bytes, counts.faces);
  if (primitive.contains("indices")) {
    const size_t indices = model.accessors[primitive["indices"].get<size_t>()].count;
    const bool is_strip = primitive.value("mode", 4) == TINYGLTF_MODE_TRIANGLE_STRIP;
    if (is_strip ? counts.faces + size_t(2) > indices : size_t(counts.faces) * 3 != indices)
      return fail(ErrorCode::bad_input,
                  "{}: its Draco data hold {} triangles, its accessor states {} indices", where,
                  counts.faces, indices);
  }
  const uint64_t most = 3 * uint64_t(counts.faces);
  if (counts.vertices > most)
    return fail(ErrorCode::bad_input, "{}: its Draco data state {} vertices for {} triangles",
                where, counts.vertices, counts.faces);
  return {};
}

Status decode_primitive(tinygltf::Model& model, const Json& stated, const Json& extension,
                        tinygltf::Primitive& primitive, const std::string& where) {
  const auto& view = model.bufferViews[extension["bufferView"].get<size_t>()];
  const DracoBytes bytes =
      DracoBytes(model.buffers[size_t(view.buffer)].data).subspan(view.byteOffset, view.byteLength);
  LUXEL_TRY(const Counts counts, stated_counts(bytes, where));
  LUXEL_TRY_STATUS(check_counts(counts, bytes.size(), model, stated, where));
  LUXEL_TRY(const std::unique_ptr<draco::Mesh> mesh, decode_mesh(bytes, where));
  for (const auto& item : extension["attributes"].items()) {
    int& accessor = primitive.attributes[item.key()];
    LUXEL_TRY(auto values, values_of(*mesh, item.value().get<uint32_t>(),
                                     model.accessors[size_t(accessor)], where + ", " + item.key()));
    accessor = add_accessor(model, model.accessors[size_t(accessor)], std::move(values));
  }
  tinygltf::Accessor triangles;
  triangles.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  triangles.type = TINYGLTF_TYPE_SCALAR;
  triangles.count = size_t(mesh->num_faces()) * 3;
  primitive.indices = add_accessor(model, triangles, indices_of(*mesh));
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  return {};
}

}  // namespace

Status decode_draco(tinygltf::Model& model, const Json& document, const std::string& file) {
  // Primitives that say the same share what was decoded, as they would share accessors.
  std::map<std::string, tinygltf::Primitive> known;
  const Json& meshes = list_of(document, "meshes");
  for (size_t m = 0; m < meshes.size(); ++m)
    for (size_t p = 0; p < meshes[m]["primitives"].size(); ++p) {
      const Json& primitive = meshes[m]["primitives"][p];
      const std::string where =
          fmt::format("{}: {}, primitive {}", file, name_of("mesh", m, meshes[m]), p);
      LUXEL_TRY(const Json* extension,
                extension_of(primitive, "KHR_draco_mesh_compression", where));
      if (extension == nullptr) continue;
      if (m >= model.meshes.size() || p >= model.meshes[m].primitives.size())
        return fail(ErrorCode::bad_input, "{}: it cannot be read", where);
      tinygltf::Primitive& out = model.meshes[m].primitives[p];
      const std::string key = Json{primitive["attributes"], primitive.value("indices", -1),
                                   primitive.value("mode", 4), *extension}
                                  .dump();
      if (const auto found = known.find(key); found != known.end()) {
        out.attributes = found->second.attributes;
        out.indices = found->second.indices;
        out.mode = found->second.mode;
        continue;
      }
      LUXEL_TRY_STATUS(decode_primitive(model, primitive, *extension, out, where));
      known.emplace(key, out);
    }
  return {};
}

}  // namespace luxel::import
