#include "luxel/export/lightmap_vertices.h"

namespace luxel::export_ {

LightmapCoordinates lightmap_places(const atlas::Atlas& atlas, std::span<const atlas::Page> pages,
                                    uint32_t instance) {
  LightmapCoordinates out;
  for (uint32_t t = atlas.first_triangle[instance]; t < atlas.first_triangle[instance + 1]; ++t) {
    out.page.push_back(atlas::page_of(atlas, t));
    const atlas::Page& page = pages[out.page.back()];
    std::array<Vec2, 3> uv = atlas.corners[t];
    for (Vec2& c : uv)
      c = {(c.x - float(page.x)) / float(page.side), (c.y - float(page.y)) / float(page.side)};
    out.uv.push_back(uv);
  }
  return out;
}

uint32_t VertexSplitter::vertex(LightmapVertices& out, uint32_t source, Vec2 lightmap) {
  for (uint32_t v = first_[source]; v != kNone; v = next_[v])
    if (out.lightmap[v] == lightmap) return v;
  const uint32_t fresh = uint32_t(out.source.size());
  out.source.push_back(source);
  out.lightmap.push_back(lightmap);
  next_.push_back(first_[source]);
  first_[source] = fresh;
  return fresh;
}

void VertexSplitter::start_next_part(const LightmapVertices& done) {
  for (const uint32_t source : done.source) first_[source] = kNone;
  next_.clear();
}

}  // namespace luxel::export_
