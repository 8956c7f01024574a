#include "luxel/post/dilate.h"

#include <limits>

#include "luxel/atlas/pages.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"

namespace luxel::post {
namespace {

struct Pixel {
  int x, y;
};

bool covered(const image::Image& lightmap, Pixel p) { return lightmap.at(p.x, p.y)[3] > 0; }

/// Calls visit(Pixel) for the neighbours of p inside the image, row by row.
template <class Visit>
void for_neighbours(const image::Image& lightmap, Pixel p, const Visit& visit) {
  for (int y = std::max(p.y - 1, 0); y <= std::min(p.y + 1, lightmap.height - 1); ++y)
    for (int x = std::max(p.x - 1, 0); x <= std::min(p.x + 1, lightmap.width - 1); ++x)
      if (x != p.x || y != p.y) visit(Pixel{x, y});
}

/// The empty texels that touch a covered one.
std::vector<Pixel> first_ring(const image::Image& lightmap) {
  std::vector<Pixel> ring;
  for (int y = 0; y < lightmap.height; ++y)
    for (int x = 0; x < lightmap.width; ++x) {
      if (covered(lightmap, {x, y})) continue;
      bool touches = false;
      for_neighbours(lightmap, {x, y}, [&](Pixel p) { touches = touches || covered(lightmap, p); });
      if (touches) ring.push_back({x, y});
    }
  return ring;
}

/// The empty texels that touch `places`, each once.
std::vector<Pixel> ring_around(const image::Image& lightmap, const std::vector<Pixel>& places,
                               std::vector<bool>& listed) {
  std::vector<Pixel> ring;
  for (const Pixel place : places)
    for_neighbours(lightmap, place, [&](Pixel p) {
      const size_t i = size_t(p.y) * size_t(lightmap.width) + size_t(p.x);
      if (listed[i] || covered(lightmap, p)) return;
      listed[i] = true;
      ring.push_back(p);
    });
  return ring;
}

Rgb mean_of_covered_neighbours(const image::Image& lightmap, Pixel place) {
  Rgb sum{};
  int count = 0;
  for_neighbours(lightmap, place, [&](Pixel p) {
    if (!covered(lightmap, p)) return;
    sum += lightmap.rgb(p.x, p.y);
    ++count;
  });
  return sum / float(count);
}

}  // namespace

image::Image lightmap_from_texels(const atlas::TexelMap& map, std::span<const Rgb> values) {
  LUXEL_CHECK(map.texels.size() == values.size());
  image::Image lightmap(map.resolution, map.resolution, 4);
  for (size_t i = 0; i < values.size(); ++i) {
    const atlas::Texel& texel = map.texels[i];
    lightmap.set_rgb(int(texel.x), int(texel.y), values[i]);
    lightmap.at(int(texel.x), int(texel.y))[3] = texel.centre_covered ? 1.0f : 0.5f;
  }
  return lightmap;
}

std::vector<image::Image> lightmap_pages(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                         std::span<const Rgb> values) {
  LUXEL_CHECK(map.texels.size() == values.size());
  const std::vector<atlas::Page> pages = atlas::pages_of(atlas);
  std::vector<image::Image> lightmaps;
  for (const atlas::Page& page : pages) lightmaps.emplace_back(page.side, page.side, 4);
  parallel_for(values.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const atlas::Texel& texel = map.texels[i];
      const uint32_t p = atlas::page_of(atlas, texel.triangle_number);
      const int x = int(texel.x) - pages[p].x, y = int(texel.y) - pages[p].y;
      lightmaps[p].set_rgb(x, y, values[i]);
      lightmaps[p].at(x, y)[3] = texel.centre_covered ? 1.0f : 0.5f;
    }
  });
  return lightmaps;
}

void dilate(image::Image& lightmap, int rings) {
  LUXEL_CHECK(lightmap.channels == 4);
  if (rings < 0) rings = std::numeric_limits<int>::max();
  std::vector<bool> listed(size_t(lightmap.width) * size_t(lightmap.height));
  std::vector<Pixel> front;
  for (int ring = 0; ring < rings; ++ring) {
    front = ring == 0 ? first_ring(lightmap) : ring_around(lightmap, front, listed);
    if (front.empty()) break;
    // All values of a ring come from the rings before it: first compute, then write.
    std::vector<Rgb> values;
    values.reserve(front.size());
    for (const Pixel p : front) values.push_back(mean_of_covered_neighbours(lightmap, p));
    for (size_t i = 0; i < front.size(); ++i) {
      lightmap.set_rgb(front[i].x, front[i].y, values[i]);
      lightmap.at(front[i].x, front[i].y)[3] = 0.5f;
    }
  }
}

}  // namespace luxel::post
