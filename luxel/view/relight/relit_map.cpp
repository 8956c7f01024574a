#include "luxel/view/relight/relit_map.h"

#include "luxel/base/check.h"

namespace luxel::view {
namespace {

/// Enough for look-ups between pixels, without mipmaps.
constexpr int kRings = 2;

/// Calls visit(pixel) for the neighbours of a pixel, row by row.
template <class Visit>
void for_pixels_around(const MapPlaces& map, uint32_t pixel, const Visit& visit) {
  const int width = map.width, x0 = int(pixel) % width, y0 = int(pixel) / width;
  for (int y = std::max(y0 - 1, 0); y <= std::min(y0 + 1, map.height - 1); ++y)
    for (int x = std::max(x0 - 1, 0); x <= std::min(x0 + 1, width - 1); ++x)
      if (x != x0 || y != y0) visit(uint32_t(y * width + x));
}

/// The pixels that touch `front` and are not covered; `is_covered` has them afterwards.
std::vector<uint32_t> add_ring(const std::vector<uint32_t>& front, std::vector<bool>& is_covered,
                               MapPlaces& map) {
  std::vector<uint32_t> ring;
  std::vector<bool> is_listed = is_covered;
  for (const uint32_t pixel : front)
    for_pixels_around(map, pixel, [&](uint32_t p) {
      if (!is_listed[p]) ring.push_back(p);
      is_listed[p] = true;
    });
  for (const uint32_t pixel : ring) {
    map.gutter.push_back(pixel);
    for_pixels_around(map, pixel, [&](uint32_t p) {
      if (is_covered[p]) map.from.push_back(p);
    });
    map.first.push_back(uint32_t(map.from.size()));
  }
  is_covered = std::move(is_listed);
  return ring;
}

void put(Rgb light, uint32_t pixel, image::Image& map) {
  float* at = map.data.data() + 4 * size_t(pixel);
  at[0] = light.x, at[1] = light.y, at[2] = light.z;
}

Rgb light_at(const image::Image& map, uint32_t pixel) {
  const float* at = map.data.data() + 4 * size_t(pixel);
  return {at[0], at[1], at[2]};
}

}  // namespace

MapPlaces map_places(const matrix::Target& target) {
  LUXEL_CHECK(target.kind == matrix::Target::Kind::texels);
  MapPlaces out;
  out.width = int(target.width), out.height = int(target.height);
  std::vector<bool> is_covered(size_t(target.width) * target.height);
  for (uint32_t k = 0; k < target.texel.size(); ++k) {
    if (target.transfer.first[k] == target.transfer.first[k + 1]) continue;
    out.place.push_back(k);
    out.pixel.push_back(target.texel[k][1] * target.width + target.texel[k][0]);
    is_covered[out.pixel.back()] = true;
  }
  out.first.push_back(0);
  std::vector<uint32_t> front = out.pixel;
  for (int ring = 0; ring < kRings; ++ring) {
    front = add_ring(front, is_covered, out);
    out.ring_end.push_back(uint32_t(out.gutter.size()));
  }
  return out;
}

void put_light(const MapPlaces& places, std::span<const Rgb> of_place, image::Image& map) {
  LUXEL_CHECK(map.width == places.width && map.height == places.height && map.channels == 4);
  for (size_t k = 0; k < places.place.size(); ++k)
    put(of_place[places.place[k]], places.pixel[k], map);
  for (size_t k = 0; k < places.gutter.size(); ++k) {
    Rgb sum{};
    for (uint32_t i = places.first[k]; i < places.first[k + 1]; ++i)
      sum += light_at(map, places.from[i]);
    put(sum / float(places.first[k + 1] - places.first[k]), places.gutter[k], map);
  }
}

}  // namespace luxel::view
