#include "luxel/post/oidn.h"

#ifdef LUXEL_OIDN
#include <OpenImageDenoise/oidn.hpp>

#include <cstring>

#include "luxel/post/dilate.h"
#endif

namespace luxel::post {

std::string_view denoiser_name() { return kHasOidn ? "oidn" : "luxel"; }

#ifdef LUXEL_OIDN

Status denoise_with_oidn(const TexelGeometry& places, std::span<const NoisyLight> parts,
                         Progress& progress) {
  oidn::DeviceRef device = oidn::newDevice(oidn::DeviceType::CPU);
  device.commit();
  for (const NoisyLight& part : parts) {
    LUXEL_TRY_STATUS(stopped(progress));
    image::Image square = lightmap_from_texels(places.map, part.values);
    dilate(square, -1);
    const size_t side = size_t(square.width), pixel = 4 * sizeof(float);
    oidn::BufferRef buffer = device.newBuffer(side * side * pixel);
    std::memcpy(buffer.getData(), square.data.data(), side * side * pixel);
    oidn::FilterRef filter = device.newFilter("RTLightmap");
    filter.setImage("color", buffer, oidn::Format::Float3, side, side, 0, pixel);
    filter.setImage("output", buffer, oidn::Format::Float3, side, side, 0, pixel);
    filter.commit();
    filter.execute();
    const char* message = nullptr;
    if (device.getError(message) != oidn::Error::None)
      return fail(ErrorCode::out_of_memory, "Open Image Denoise failed: {}", message);
    std::memcpy(square.data.data(), buffer.getData(), side * side * pixel);
    for (size_t i = 0; i < part.values.size(); ++i) {
      const atlas::Texel& t = places.map.texels[i];
      const Rgb v = square.rgb(int(t.x), int(t.y));
      if (!places.hidden[i] && is_finite(v)) part.values[i] = max(v, Rgb{});
    }
  }
  return {};
}

#else

Status denoise_with_oidn(const TexelGeometry&, std::span<const NoisyLight>, Progress&) {
  return fail(ErrorCode::bad_setting, "this build has no Open Image Denoise");
}

#endif

}  // namespace luxel::post
