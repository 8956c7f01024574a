// Views lie in their buffers, accessors in their views, nodes form trees.
#include <cmath>
#include <vector>

#include "luxel/import/gltf_check_steps.h"

namespace luxel::import {
namespace {

/// Elements that no bytes back (zeros, or sparse): a bound on what a short file can ask us to hold.
constexpr uint64_t kMaxUnbackedElements = uint64_t(1) << 26;

uint64_t component_size(uint64_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

uint64_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  if (type == "MAT4") return 16;
  return 0;
}

/// An array of `count` elements inside a view.
struct Extent {
  uint64_t view, offset, count, element_size;
};

Status check_extent(const Json& document, const Extent& extent, bool strided,
                    const std::string& where) {
  const Json& views = list_of(document, "bufferViews");
  if (extent.view >= views.size())
    return fail(ErrorCode::bad_input, "{}: bufferView {} is out of range, there are {} bufferViews",
                where, extent.view, views.size());
  const Json& view = views[extent.view];
  LUXEL_TRY(const uint64_t length, whole_number(view, "byteLength", 0, where));
  LUXEL_TRY(const uint64_t stated, whole_number(view, "byteStride", 0, where));
  const uint64_t stride = strided && stated ? stated : extent.element_size;
  if (extent.count == 0) return {};
  // By division: the product of two numbers from a file may not fit.
  const bool fits = extent.offset <= length && extent.element_size <= length - extent.offset &&
                    extent.count - 1 <= (length - extent.offset - extent.element_size) / stride;
  if (!fits)
    return fail(ErrorCode::bad_input,
                "{}: {} elements of {} bytes from byte {} on reach past the {} bytes of bufferView "
                "{}",
                where, extent.count, extent.element_size, extent.offset, length, extent.view);
  return {};
}

Status check_sparse(const Json& document, const Json& sparse, uint64_t count, uint64_t element_size,
                    const std::string& where) {
  if (!sparse.is_object() || !sparse.contains("indices") || !sparse.contains("values") ||
      !sparse["indices"].is_object() || !sparse["values"].is_object())
    return fail(ErrorCode::bad_input, "{}: its sparse part lacks indices or values", where);
  const Json &indices = sparse["indices"], &values = sparse["values"];
  LUXEL_TRY(const uint64_t entries, whole_number(sparse, "count", UINT64_MAX, where));
  LUXEL_TRY(const uint64_t type, whole_number(indices, "componentType", UINT64_MAX, where));
  if (type != 5121 && type != 5123 && type != 5125)
    return fail(ErrorCode::bad_input, "{}: sparse indices have component type {}; must be unsigned",
                where, type);
  if (entries > count)
    return fail(ErrorCode::bad_input, "{}: {} sparse entries for {} elements", where, entries,
                count);
  LUXEL_TRY(const uint64_t index_view, whole_number(indices, "bufferView", UINT64_MAX, where));
  LUXEL_TRY(const uint64_t index_offset, whole_number(indices, "byteOffset", 0, where));
  LUXEL_TRY(const uint64_t value_view, whole_number(values, "bufferView", UINT64_MAX, where));
  LUXEL_TRY(const uint64_t value_offset, whole_number(values, "byteOffset", 0, where));
  LUXEL_TRY_STATUS(check_extent(document, {index_view, index_offset, entries, component_size(type)},
                                false, where));
  return check_extent(document, {value_view, value_offset, entries, element_size}, false, where);
}

Status check_accessor(const Json& document, const Json& accessor, const std::string& where) {
  LUXEL_TRY(const uint64_t type, whole_number(accessor, "componentType", UINT64_MAX, where));
  LUXEL_TRY(const uint64_t count, whole_number(accessor, "count", UINT64_MAX, where));
  LUXEL_TRY(const uint64_t offset, whole_number(accessor, "byteOffset", 0, where));
  const auto shape = accessor.find("type");
  const uint64_t components =
      shape != accessor.end() && shape->is_string() ? component_count(*shape) : 0;
  const uint64_t element_size = component_size(type) * components;
  if (element_size == 0)
    return fail(ErrorCode::bad_input, "{}: its type or componentType ({}) is not one of glTF's",
                where, type);
  if (count > UINT32_MAX)
    return fail(ErrorCode::bad_input, "{}: {} elements are too many", where, count);
  if (accessor.contains("bufferView")) {
    const uint64_t view = accessor["bufferView"].get<uint64_t>();
    LUXEL_TRY_STATUS(check_extent(document, {view, offset, count, element_size}, true, where));
  } else if (count > kMaxUnbackedElements) {
    return fail(ErrorCode::bad_input, "{}: {} elements without a bufferView are too many", where,
                count);
  }
  if (!accessor.contains("sparse")) return {};
  return check_sparse(document, accessor["sparse"], count, element_size, where);
}

Status check_view(const Json& document, const Json& view, const std::string& where) {
  if (!view.contains("buffer")) return fail(ErrorCode::bad_input, "{}: it names no buffer", where);
  const uint64_t buffer = view["buffer"].get<uint64_t>();
  LUXEL_TRY(const uint64_t size,
            whole_number(list_of(document, "buffers")[buffer], "byteLength", UINT64_MAX,
                         fmt::format("{}, buffer {}", where, buffer)));
  LUXEL_TRY(const uint64_t offset, whole_number(view, "byteOffset", 0, where));
  LUXEL_TRY(const uint64_t length, whole_number(view, "byteLength", UINT64_MAX, where));
  if (offset + length > size)
    return fail(ErrorCode::bad_input, "{}: bytes {} to {} reach past the {} bytes of buffer {}",
                where, offset, offset + length, size, buffer);
  return {};
}

}  // namespace

Result<uint64_t> whole_number(const Json& object, const char* key, uint64_t fallback,
                              const std::string& where) {
  const auto value = object.find(key);
  if (value == object.end()) {
    if (fallback == UINT64_MAX) return fail(ErrorCode::bad_input, "{}: it has no {}", where, key);
    return fallback;
  }
  const double number = value->is_number() ? value->get<double>() : -1.0;
  if (!(number >= 0) || number > 0x1p53 || number != std::floor(number))
    return fail(ErrorCode::bad_input, "{}: {} is {}, must be a whole number from 0 on", where, key,
                value->dump());
  return uint64_t(number);
}

Status check_ranges(const Json& document, const std::string& file) {
  // Also of buffers that no view names: what was read is compared with it.
  const Json& buffers = list_of(document, "buffers");
  for (size_t i = 0; i < buffers.size(); ++i)
    LUXEL_TRY_STATUS(whole_number(buffers[i], "byteLength", UINT64_MAX,
                                  file + ": " + name_of("buffer", i, buffers[i])));
  const Json& views = list_of(document, "bufferViews");
  for (size_t i = 0; i < views.size(); ++i)
    LUXEL_TRY_STATUS(
        check_view(document, views[i], file + ": " + name_of("buffer view", i, views[i])));
  const Json& accessors = list_of(document, "accessors");
  for (size_t i = 0; i < accessors.size(); ++i)
    LUXEL_TRY_STATUS(
        check_accessor(document, accessors[i], file + ": " + name_of("accessor", i, accessors[i])));
  return {};
}

Status check_trees(const Json& document, const std::string& file) {
  constexpr size_t kNobody = SIZE_MAX;
  const Json& nodes = list_of(document, "nodes");
  std::vector<size_t> parent(nodes.size(), kNobody);
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].contains("children")) continue;
    for (const Json& child : nodes[i]["children"]) {
      size_t& its_parent = parent[child.get<size_t>()];
      if (its_parent != kNobody)
        return fail(ErrorCode::bad_input, "{}: node {} has two parents, {} and {}", file,
                    child.get<size_t>(), its_parent, i);
      its_parent = i;
    }
  }
  // With one parent each, a cycle is a walk upwards that comes back to a node it has passed. It
  // stops where an earlier walk has been.
  std::vector<size_t> passed_by(nodes.size(), kNobody);
  for (size_t start = 0; start < nodes.size(); ++start)
    for (size_t i = start; i != kNobody; i = parent[i]) {
      if (passed_by[i] == start)
        return fail(ErrorCode::bad_input, "{}: node {} is its own ancestor", file, i);
      if (passed_by[i] != kNobody) break;
      passed_by[i] = start;
    }
  return {};
}

}  // namespace luxel::import
