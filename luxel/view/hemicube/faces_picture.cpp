#include "luxel/view/hemicube/faces_picture.h"

#include <algorithm>

#include "luxel/display/draw.h"
#include "luxel/image/text.h"
#include "luxel/view/draw/surface_corners.h"

namespace luxel::view {
namespace {

using image::Color8;
using image::Image8;

constexpr Color8 kOpen{205, 215, 225};  // surroundings, among items
constexpr Color8 kInk{235, 235, 235}, kBar{120, 180, 255}, kAxis{110, 110, 110};
constexpr uint8_t kGround = 24, kOpaque = 232;
constexpr int kHistogramHeight = 40, kPadding = 4;

Image8 transparent(int width, int height) {
  return {width, height, 4, std::vector<uint8_t>(size_t(4 * width * height))};
}

void set_pixel(Image8& picture, int x, int y, Color8 color) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  uint8_t* pixel = picture.data.data() + 4 * (size_t(y) * size_t(picture.width) + size_t(x));
  std::copy(color.begin(), color.end(), pixel);
  pixel[3] = 255;
}

Rgb radiance_of(const LightMesh& mesh, const VertexReport& report, size_t pixel) {
  const hemicube::Item& item = report.items.items[pixel];
  const scene::Scene& scene = mesh.in->scene;
  if (item.kind == hemicube::SeenKind::surroundings)
    return scene::smooth_surroundings_towards(scene, report.items.direction[pixel]);
  if (item.kind != hemicube::SeenKind::surface) return {};
  const hemicube::Node& node = mesh.mesh.nodes[item.at.node];
  const auto irradiance = [&](const scene::SurfacePoint&) {
    if (mesh.receivers.kind == hemicube::ElementKind::triangle)
      return report.light[mesh.receivers.leaf_of_node[item.at.node]];
    return interpolate(report.light[node.vertex[0]], report.light[node.vertex[1]],
                       report.light[node.vertex[2]], item.at.at);
  };
  return display::seen_radiance(scene, hemicube::scene_point(node, item.at.at), irradiance);
}

Color8 item_shown(const LightMesh& mesh, const hemicube::Item& item) {
  if (item.kind == hemicube::SeenKind::surroundings) return kOpen;
  if (item.kind != hemicube::SeenKind::surface) return {0, 0, 0};
  const uint32_t color = item_color(mesh.receivers.leaf_of_node[item.at.node]);
  return {uint8_t(color), uint8_t(color >> 8), uint8_t(color >> 16)};
}

/// Each pixel of the target's upper middle shows one of the picture; larger ones in whole steps.
void put_scaled(const Image8& from, int side, Image8& to) {
  const int scale = std::max(1, side / from.width);
  const int shown = from.width <= side ? from.width * scale : side;
  const int margin = (side - shown) / 2;
  for (int y = 0; y < shown; ++y)
    for (int x = 0; x < shown; ++x) {
      const int u = int(int64_t(x) * from.width / shown), v = int(int64_t(y) * from.height / shown);
      const uint8_t* pixel = from.data.data() + 4 * (size_t(v) * size_t(from.width) + size_t(u));
      const int left = (to.width - side) / 2 + margin;
      if (pixel[3] != 0) set_pixel(to, left + x, margin + y, {pixel[0], pixel[1], pixel[2]});
    }
}

/// Bars of the row's factors by powers of ten, and these.
void draw_histogram(const VertexReport& report, int top, Image8& out) {
  const auto bins = histogram_of_row(report.row);
  const double most = std::max(1u, *std::max_element(bins.begin(), bins.end()));
  const int wide = std::max(2, (out.width - 2 * kPadding) / int(kFactorBins));
  const int bottom = top + kHistogramHeight;
  for (size_t k = 0; k < kFactorBins; ++k) {
    const int height = int(double(bins[k]) / most * (kHistogramHeight - 2) + 0.999);
    for (int x = 0; x + 1 < wide; ++x)
      for (int y = 0; y < height; ++y)
        set_pixel(out, kPadding + int(k) * wide + x, bottom - 1 - y, kBar);
  }
  for (int x = 0; x < int(kFactorBins) * wide; ++x) set_pixel(out, kPadding + x, bottom, kAxis);
  for (int power = -6; power < 0; power += 2) {
    const int x = kPadding + (power + 7) * 4 * wide;
    for (int y = 0; y < 3; ++y) set_pixel(out, x, bottom + y, kAxis);
    image::draw_text(out, x - 9, bottom + 3, 1, kInk, fmt::format("1e{}", power));
  }
}

}  // namespace

CrossPlace place_in_cross(int resolution, size_t pixel) {
  const int n = resolution, h = n / 2;
  const size_t top = size_t(n) * size_t(n), side = top / 2;
  const int row = int((pixel < top ? pixel : (pixel - top) % side) / size_t(n));
  const int column = int((pixel < top ? pixel : (pixel - top) % side) % size_t(n));
  if (pixel < top) return {h + column, h + row};
  // The top's right is -x and its rows go down from +y; each side begins with the row beside it.
  switch ((pixel - top) / side) {
    case 0:
      return {h - 1 - row, h + column};  // +x
    case 1:
      return {h + n + row, h + n - 1 - column};  // -x
    case 2:
      return {h + n - 1 - column, h - 1 - row};  // +y
    default:
      return {h + column, h + n + row};  // -y
  }
}

Image8 faces_picture(const LightMesh& mesh, const VertexReport& report, const FacesLook& look) {
  const int n = report.resolution;
  Image8 out = transparent(2 * n, 2 * n);
  image::Image light(look.faces == Faces::lit ? 2 * n : 1, look.faces == Faces::lit ? 2 * n : 1, 4);
  for (size_t i = 0; i < report.items.items.size(); ++i) {
    const CrossPlace at = place_in_cross(n, i);
    if (look.faces == Faces::lit) light.set_rgb(at.x, at.y, radiance_of(mesh, report, i));
    set_pixel(out, at.x, at.y, item_shown(mesh, report.items.items[i]));
  }
  if (look.faces == Faces::items) return out;
  const Image8 shown = display::tone_map(light, look.exposure, look.curve);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const size_t i = size_t(y) * size_t(out.width) + size_t(x);
      if (out.data[4 * i + 3] == 0) continue;
      const uint8_t* from = shown.data.data() + size_t(shown.channels) * i;
      set_pixel(out, x, y, {from[0], from[1], from[2]});
    }
  return out;
}

std::vector<std::string> lines_of(const VertexReport& r, const std::string& unit) {
  std::vector<std::string> out;
  out.push_back(fmt::format("element {}, {} x {}", r.element, r.resolution, r.resolution));
  out.push_back(r.exact ? fmt::format("sum {:.5f}, exact {:.5f}", r.sum, r.exact->sum)
                        : fmt::format("sum {:.5f}", r.sum));
  out.push_back(fmt::format("missing {:.5f}", 1 - r.sum));
  if (r.open > 0) out.push_back(fmt::format("  surroundings {:.5f}", r.open));
  if (r.back > 0) out.push_back(fmt::format("  backs {:.5f}", r.back));
  if (r.below > 0) out.push_back(fmt::format("  below {:.5f}", r.below));
  if (r.exact) out.push_back(fmt::format("wrong triangles {:.3f} %", 100 * r.exact->wrong));
  out.push_back(fmt::format("E {:.5g} {}", luminance(r.irradiance), unit));
  return out;
}

Image8 report_picture(const LightMesh& mesh, const VertexReport& report, const FacesLook& look,
                      int side, const std::string& unit) {
  const std::vector<std::string> lines = lines_of(report, unit);
  const int line = image::kGlyphHeight + 2;
  const int text = kPadding + line * int(lines.size());
  int width = side;
  for (const std::string& one : lines)
    width = std::max(width, image::text_width(one, 1) + 2 * kPadding);
  Image8 out = transparent(width, side + text + kHistogramHeight + 3 + line + kPadding);
  for (size_t i = 0; i < out.data.size(); ++i) out.data[i] = i % 4 == 3 ? kOpaque : kGround;
  put_scaled(faces_picture(mesh, report, look), side, out);
  for (size_t i = 0; i < lines.size(); ++i)
    image::draw_text(out, kPadding, side + kPadding + int(i) * line, 1, kInk, lines[i]);
  draw_histogram(report, side + text, out);
  return out;
}

}  // namespace luxel::view
