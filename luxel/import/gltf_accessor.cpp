#include "luxel/import/gltf_accessor.h"

#include <algorithm>
#include <cstring>

namespace luxel::import {
namespace {

template <class T>
T load(const unsigned char* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return value;
}

/// One component as a number. [glTF 2.0, section 3.6.2.2: c / 127 and so on, at least -1]
double component(const unsigned char* p, int type, bool normalized) {
  const auto scaled = [&](double value, double largest) {
    return normalized ? std::max(value / largest, -1.0) : value;
  };
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return scaled(load<int8_t>(p), 127);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return scaled(load<uint8_t>(p), 255);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return scaled(load<int16_t>(p), 32767);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return scaled(load<uint16_t>(p), 65535);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return scaled(load<uint32_t>(p), 4294967295.0);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return load<float>(p);
    default:
      return 0;  // check_document() let no other type through
  }
}

/// The place of an element array: bytes of its first element and from one element to the next.
struct Rows {
  const unsigned char* first = nullptr;
  size_t stride = 0;
};

Rows rows_at(const tinygltf::Model& model, int view_index, size_t offset, size_t element_size) {
  const tinygltf::BufferView& view = model.bufferViews[size_t(view_index)];
  const std::vector<unsigned char>& data = model.buffers[size_t(view.buffer)].data;
  return {data.data() + view.byteOffset + offset, view.byteStride ? view.byteStride : element_size};
}

struct Layout {
  size_t components, component_size, element_size;
};

Layout layout_of(const tinygltf::Accessor& accessor) {
  const size_t components = size_t(tinygltf::GetNumComponentsInType(uint32_t(accessor.type)));
  const size_t size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType)));
  return {components, size, components * size};
}

/// Replaces the elements that the accessor's sparse part lists.
/// Calls put(element, bytes of the new element).
template <class Put>
Status for_each_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                       const std::string& where, const Put& put) {
  const auto& sparse = accessor.sparse;
  if (!sparse.isSparse) return {};
  const size_t index_size =
      size_t(tinygltf::GetComponentSizeInBytes(uint32_t(sparse.indices.componentType)));
  const size_t element_size = layout_of(accessor).element_size;
  const Rows indices =
      rows_at(model, sparse.indices.bufferView, size_t(sparse.indices.byteOffset), index_size);
  const Rows values =
      rows_at(model, sparse.values.bufferView, size_t(sparse.values.byteOffset), element_size);
  for (size_t i = 0; i < size_t(sparse.count); ++i) {
    // The specification allows no stride in the views of a sparse part.
    const auto element =
        size_t(component(indices.first + i * index_size, sparse.indices.componentType, false));
    if (element >= accessor.count)
      return fail(ErrorCode::bad_input,
                  "{}: sparse index {} is out of range, the accessor has {} elements", where,
                  element, accessor.count);
    put(element, values.first + i * element_size);
  }
  return {};
}

}  // namespace

Result<Numbers> read_numbers(const tinygltf::Model& model, int accessor_index,
                             std::initializer_list<size_t> components, const std::string& where) {
  const tinygltf::Accessor& accessor = model.accessors[size_t(accessor_index)];
  const Layout layout = layout_of(accessor);
  if (std::find(components.begin(), components.end(), layout.components) == components.end())
    return fail(ErrorCode::bad_input, "{}: accessor {} has {} numbers per element, must be {}",
                where, accessor_index, layout.components, *components.begin());
  Numbers numbers{layout.components, std::vector<float>(accessor.count * layout.components)};
  const auto put = [&](size_t element, const unsigned char* bytes) {
    float* out = numbers.values.data() + element * layout.components;
    for (size_t k = 0; k < layout.components; ++k)
      out[k] = float(component(bytes + k * layout.component_size, accessor.componentType,
                               accessor.normalized));
  };
  if (accessor.bufferView >= 0) {
    const Rows rows = rows_at(model, accessor.bufferView, accessor.byteOffset, layout.element_size);
    for (size_t i = 0; i < accessor.count; ++i) put(i, rows.first + i * rows.stride);
  }
  LUXEL_TRY_STATUS(for_each_sparse(model, accessor, where, put));
  return numbers;
}

Result<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, int accessor_index,
                                           const std::string& where) {
  const tinygltf::Accessor& accessor = model.accessors[size_t(accessor_index)];
  const Layout layout = layout_of(accessor);
  const int type = accessor.componentType;
  const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (layout.components != 1 || !is_unsigned)
    return fail(ErrorCode::bad_input, "{}: indices (accessor {}) must be unsigned scalars", where,
                accessor_index);
  std::vector<uint32_t> indices(accessor.count);
  const auto put = [&](size_t element, const unsigned char* bytes) {
    indices[element] = uint32_t(component(bytes, type, false));
  };
  if (accessor.bufferView >= 0) {
    const Rows rows = rows_at(model, accessor.bufferView, accessor.byteOffset, layout.element_size);
    for (size_t i = 0; i < accessor.count; ++i) put(i, rows.first + i * rows.stride);
  }
  LUXEL_TRY_STATUS(for_each_sparse(model, accessor, where, put));
  return indices;
}

}  // namespace luxel::import
