// EXT_ and KHR_meshopt_compression: what compressed views may say, and which buffers need no bytes.
#include <span>

#include "luxel/import/gltf_check_steps.h"

namespace luxel::import {
namespace {

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

const char* extension_name(const MeshoptView& v) { return kMeshopt[v.khr ? 1 : 0]; }

/// The position of a word in a list of words.
Result<size_t> choice(const Json& object, const char* key, std::span<const char* const> words,
                      const std::string& where) {
  const auto value = object.find(key);
  for (size_t i = 0; i < words.size(); ++i)
    if (value != object.end() && *value == words[i]) return i;
  std::string all;
  for (const char* word : words) all += fmt::format("{}{}", all.empty() ? "" : ", ", word);
  return fail(ErrorCode::bad_input, "{}: {} is {}, must be one of {}", where, key,
              value == object.end() ? "missing" : value->dump(), all);
}

/// The most bytes that `length` compressed ones can become. Without this a short file could ask for
/// any amount of memory, for decoders write where the caller has made room. Attributes: a byte
/// stands for four groups of 16 bytes that do not change, or in KHR's format 1 for four bytes of
/// 256 elements. Indices: at least a byte for each triangle, or for each index of a sequence.
/// [KHR_meshopt_compression, appendix A]
uint64_t most_bytes(const MeshoptView& v) {
  if (v.mode == MeshoptView::Mode::attributes) return (v.khr ? 1024 : 64) * v.length;
  return v.length * v.stride * (v.mode == MeshoptView::Mode::triangles ? 3 : 1);
}

Status check_layout(const MeshoptView& v, const std::string& where) {
  using Mode = MeshoptView::Mode;
  using Filter = MeshoptView::Filter;
  const auto wrong_stride = [&](const char* must) {
    return fail(ErrorCode::bad_input, "{}: byteStride is {}, must be {}", where, v.stride, must);
  };
  if (v.mode != Mode::attributes) {
    if (v.stride != 2 && v.stride != 4) return wrong_stride("2 or 4 for indices");
    if (v.filter != Filter::none)
      return fail(ErrorCode::bad_input, "{}: indices cannot have a filter", where);
    if (v.mode == Mode::triangles && v.count % 3 != 0)
      return fail(ErrorCode::bad_input, "{}: count is {}, must be a multiple of 3 for triangles",
                  where, v.count);
    return {};
  }
  if (v.stride == 0 || v.stride > 256 || v.stride % 4 != 0)
    return wrong_stride("a multiple of 4, at most 256");
  if (v.filter == Filter::octahedral && v.stride != 4 && v.stride != 8)
    return wrong_stride("4 or 8 for the filter OCTAHEDRAL");
  if (v.filter == Filter::quaternion && v.stride != 8)
    return wrong_stride("8 for the filter QUATERNION");
  if (v.filter == Filter::color && v.stride != 4 && v.stride != 8)
    return wrong_stride("4 or 8 for the filter COLOR");
  return {};
}

/// Against the compressed bytes, and against the view that they fill.
Status check_sizes(const Json& document, const MeshoptView& v, const Json& view,
                   const std::string& where) {
  LUXEL_TRY(const uint64_t size,
            whole_number(list_of(document, "buffers")[v.buffer], "byteLength", UINT64_MAX, where));
  if (v.offset + v.length > size)
    return fail(ErrorCode::bad_input, "{}: bytes {} to {} reach past the {} bytes of buffer {}",
                where, v.offset, v.offset + v.length, size, v.buffer);
  LUXEL_TRY(const uint64_t stated, whole_number(view, "byteLength", UINT64_MAX, where));
  LUXEL_TRY(const uint64_t stride, whole_number(view, "byteStride", v.stride, where));
  // By division: the product of two numbers from a file may not fit.
  if (stated / v.stride != v.count || stated % v.stride != 0)
    return fail(ErrorCode::bad_input,
                "{}: count {} times byteStride {} is not the byteLength {} of the view", where,
                v.count, v.stride, stated);
  if (stride != v.stride)
    return fail(ErrorCode::bad_input, "{}: byteStride is {}, but {} in the view", where, v.stride,
                stride);
  if (stated > most_bytes(v))
    return fail(ErrorCode::bad_input,
                "{}: its {} compressed bytes cannot become {} bytes, at most {}", where, v.length,
                stated, most_bytes(v));
  return {};
}

bool is_marked_fallback(const Json& buffer) {
  for (const char* name : kMeshopt) {
    const Json::json_pointer fallback(fmt::format("/extensions/{}/fallback", name));
    if (buffer.contains(fallback) && buffer[fallback] == true) return true;
  }
  return false;
}

/// Views that use a buffer: the first that reads it plainly, and the first that reads compressed
/// bytes from it. `replaced`: some view would lie in it if it were not compressed.
struct Use {
  static constexpr size_t kNobody = SIZE_MAX;
  size_t plain = kNobody, compressed = kNobody;
  bool replaced = false;
};

/// Only after check_indices(); what is wrong with a view is said elsewhere.
std::vector<Use> uses_of_buffers(const Json& document) {
  std::vector<Use> uses(list_of(document, "buffers").size());
  const auto note = [](size_t& first, size_t view) {
    if (first == Use::kNobody) first = view;
  };
  const Json& views = list_of(document, "bufferViews");
  for (size_t i = 0; i < views.size(); ++i) {
    Use& own = uses[views[i]["buffer"].get<size_t>()];
    const auto view = meshopt_view_of(document, views[i], "");
    if (!view || !view->has_value()) {
      note(own.plain, i);
    } else {
      own.replaced = true;
      note(uses[(*view)->buffer].compressed, i);
    }
  }
  return uses;
}

}  // namespace

Result<std::optional<MeshoptView>> meshopt_view_of(const Json& document, const Json& view,
                                                   const std::string& view_name) {
  LUXEL_TRY(const Json* const ext, extension_of(view, kMeshopt[0], view_name));
  LUXEL_TRY(const Json* const khr, extension_of(view, kMeshopt[1], view_name));
  if (ext == nullptr && khr == nullptr) return std::nullopt;
  if (ext != nullptr && khr != nullptr)
    return fail(ErrorCode::bad_input, "{}: it has both {} and {}, must have one", view_name,
                kMeshopt[0], kMeshopt[1]);
  MeshoptView v;
  v.khr = khr != nullptr;
  const Json* const extension = v.khr ? khr : ext;
  const std::string where = view_name + ", " + extension_name(v);
  LUXEL_TRY_STATUS(check_index(document, *extension, "buffer", "buffers", where));
  LUXEL_TRY(v.buffer, whole_number(*extension, "buffer", UINT64_MAX, where));
  LUXEL_TRY(v.offset, whole_number(*extension, "byteOffset", 0, where));
  LUXEL_TRY(v.length, whole_number(*extension, "byteLength", UINT64_MAX, where));
  LUXEL_TRY(v.stride, whole_number(*extension, "byteStride", UINT64_MAX, where));
  LUXEL_TRY(v.count, whole_number(*extension, "count", UINT64_MAX, where));
  constexpr const char* kModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
  constexpr const char* kFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"};
  LUXEL_TRY(const size_t mode, choice(*extension, "mode", kModes, where));
  v.mode = MeshoptView::Mode(mode);
  if (extension->contains("filter")) {
    LUXEL_TRY(const size_t filter,
              choice(*extension, "filter", std::span(kFilters).first(v.khr ? 5 : 4), where));
    v.filter = MeshoptView::Filter(filter);
  }
  LUXEL_TRY_STATUS(check_layout(v, where));
  LUXEL_TRY_STATUS(check_sizes(document, v, view, where));
  return v;
}

Status check_meshopt(const Json& document, const std::string& file) {
  // Each view states what its bytes can hold.
  const Json& views = list_of(document, "bufferViews");
  const auto view_name = [&](size_t i) {
    return file + ": " + name_of("buffer view", i, views[i]);
  };
  for (size_t i = 0; i < views.size(); ++i)
    LUXEL_TRY_STATUS(meshopt_view_of(document, views[i], view_name(i)));
  // Pictures are never compressed so.
  const Json& images = list_of(document, "images");
  for (size_t i = 0; i < images.size(); ++i) {
    if (!images[i].contains("bufferView")) continue;
    const size_t view = images[i]["bufferView"].get<size_t>();
    LUXEL_TRY(const auto compressed, meshopt_view_of(document, views[view], view_name(view)));
    if (compressed)
      return fail(ErrorCode::unsupported,
                  "{}: {} lies in buffer view {}, which {} compresses; "
                  "export pictures as they are",
                  file, name_of("image", i, images[i]), view, extension_name(*compressed));
  }
  // Buffers that are marked as fallback have bytes that no view needs.
  const std::vector<Use> uses = uses_of_buffers(document);
  for (size_t i = 0; i < uses.size(); ++i) {
    const size_t user = uses[i].plain != Use::kNobody ? uses[i].plain : uses[i].compressed;
    if (user != Use::kNobody && is_marked_fallback(list_of(document, "buffers")[i]))
      return fail(ErrorCode::bad_input,
                  "{}: buffer {} is marked as fallback, but buffer view {} needs its bytes", file,
                  i, user);
  }
  return {};
}

std::vector<bool> placeholder_buffers(const Json& document) {
  const std::vector<Use> uses = uses_of_buffers(document);
  std::vector<bool> is_placeholder(uses.size());
  for (size_t i = 0; i < uses.size(); ++i)
    is_placeholder[i] =
        uses[i].replaced && uses[i].plain == Use::kNobody && uses[i].compressed == Use::kNobody;
  return is_placeholder;
}

}  // namespace luxel::import
