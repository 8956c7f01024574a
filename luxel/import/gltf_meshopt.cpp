// EXT_ and KHR_meshopt_compression, by meshoptimizer where it can. Its decoders bear any input, as
// long as sizes are such as its assertions ask for; meshopt_view_of() sees to that.
#include <meshoptimizer.h>

#include "luxel/import/gltf_check_steps.h"
#include "luxel/import/gltf_load.h"
#include "luxel/import/meshopt_attributes.h"

namespace luxel::import {
namespace {

using Mode = MeshoptView::Mode;
using Filter = MeshoptView::Filter;

/// 0 when all went well.
int decode(const MeshoptView& v, const unsigned char* compressed, std::span<unsigned char> out) {
  constexpr unsigned char kFormat1 = 0xa1;
  unsigned char* const decoded = out.data();
  switch (v.mode) {
    case Mode::attributes:
      if (v.khr && v.length > 0 && compressed[0] == kFormat1)
        return decode_attributes({compressed + 1, v.length - 1}, v.stride, out) ? 0 : -1;
      return meshopt_decodeVertexBuffer(decoded, v.count, v.stride, compressed, v.length);
    case Mode::triangles:
      return meshopt_decodeIndexBuffer(decoded, v.count, v.stride, compressed, v.length);
    case Mode::indices:
      return meshopt_decodeIndexSequence(decoded, v.count, v.stride, compressed, v.length);
  }
  return -1;
}

void apply_filter(const MeshoptView& v, std::span<unsigned char> out) {
  unsigned char* const decoded = out.data();
  if (v.filter == Filter::octahedral) meshopt_decodeFilterOct(decoded, v.count, v.stride);
  if (v.filter == Filter::quaternion) meshopt_decodeFilterQuat(decoded, v.count, v.stride);
  if (v.filter == Filter::exponential) meshopt_decodeFilterExp(decoded, v.count, v.stride);
  if (v.filter == Filter::color) decode_colors(v.stride, out);
}

Status decode_view(tinygltf::Model& model, size_t index, const MeshoptView& v,
                   const std::string& where, ReadingMemory& memory) {
  LUXEL_TRY_STATUS(memory.take(v.count * v.stride, where));
  tinygltf::Buffer decoded;
  decoded.data.resize(v.count * v.stride);
  const int status = decode(v, model.buffers[v.buffer].data.data() + v.offset, decoded.data);
  if (status != 0)
    return fail(ErrorCode::bad_input,
                "{}: the {} compressed bytes at {} of buffer {} are damaged or are not {} elements "
                "of {} bytes (error {} of its decoder); export it again",
                where, v.length, v.offset, v.buffer, v.count, v.stride, status);
  apply_filter(v, decoded.data);
  tinygltf::BufferView& view = model.bufferViews[index];
  view.buffer = int(model.buffers.size());
  view.byteOffset = 0;
  model.buffers.push_back(std::move(decoded));
  return {};
}

}  // namespace

Status decode_meshopt(tinygltf::Model& model, const Json& document, const SourceFile& source) {
  const Json& views = list_of(document, "bufferViews");
  for (size_t i = 0; i < views.size(); ++i) {
    const std::string where = source.name + ": " + name_of("buffer view", i, views[i]);
    LUXEL_TRY(const std::optional<MeshoptView> view, meshopt_view_of(document, views[i], where));
    if (view) LUXEL_TRY_STATUS(decode_view(model, i, *view, where, source.memory));
  }
  return {};
}

}  // namespace luxel::import
