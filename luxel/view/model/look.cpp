#include "luxel/view/model/look.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/file.h"
#include "luxel/display/bilinear.h"
#include "luxel/display/lightmap_lookup.h"
#include "luxel/image/false_color.h"
#include "luxel/image/value_scale.h"
#include "luxel/pipeline/texels/texel_picture.h"
#include "luxel/view/model/uv_overlaps.h"

namespace luxel::view {
namespace {

/// Neighbours, the nearest first.
constexpr std::array<std::array<int, 2>, 8> kAround{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

/// Where a logarithmic scale begins that would begin at 0, over its end.
constexpr float kLowestOfLogarithm = 1e-3f;

ColorScale irradiance_scale(const pipeline::LightmapPages& lightmaps) {
  std::vector<float> values;
  for (const image::Image& page : lightmaps.pictures)
    for (int y = 0; y < page.height; ++y)
      for (int x = 0; x < page.width; ++x)
        if (page.channels < 4 || page.at(x, y)[3] > 0) values.push_back(luminance(page.rgb(x, y)));
  return {0, float(image::scale_for(values, "").top), false};
}

std::span<const Vec2> places_of(const scene::Scene& scene, size_t mesh,
                                std::span<const std::vector<Vec2>> light_uv) {
  return light_uv.empty() ? scene.meshes[mesh].uv1 : light_uv[mesh];
}

/// The surface of a scene by its density.
struct DensityShare {
  float per_metre = 0;
  double area = 0;
};

/// A triangle's texels per metre and its area, twice; 0 where it has none. `places`: of the mesh's
/// vertices in the lightmap.
DensityShare density_of(const scene::Mesh& mesh, size_t triangle, const Mat34& world_from_object,
                        std::span<const Vec2> places, const image::Image& page) {
  std::array<Vec3, 3> p;
  std::array<Vec2, 3> uv;
  for (size_t k = 0; k < 3; ++k) {
    const uint32_t corner = mesh.triangles[triangle][k];
    p[k] = transform_point(world_from_object, mesh.positions[corner]);
    uv[k] = {places[corner].x * float(page.width), places[corner].y * float(page.height)};
  }
  const float area = length(cross(p[1] - p[0], p[2] - p[0]));
  const float texels = std::abs(cross(uv[1] - uv[0], uv[2] - uv[0]));
  return {area > 0 ? std::sqrt(texels / area) : 0, double(area)};
}

void add_densities(const scene::Mesh& mesh, const Mat34& world_from_object,
                   std::span<const Vec2> places, const pipeline::LightmapPages& lightmaps,
                   std::vector<DensityShare>& out) {
  if (places.empty()) return;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const size_t page = lightmaps.of_material[mesh.triangle_material[t]];
    const DensityShare share =
        density_of(mesh, t, world_from_object, places, lightmaps.pictures[page]);
    if (share.per_metre > 0) out.push_back(share);
  }
}

/// Where a share of the surface has less.
float density_below(const std::vector<DensityShare>& sorted, double share) {
  double all = 0, so_far = 0;
  for (const DensityShare& d : sorted) all += d.area;
  for (const DensityShare& d : sorted)
    if ((so_far += d.area) >= share * all) return d.per_metre;
  return 1;
}

/// At least a factor of four, so that an even density is one even colour.
ColorScale density_scale(const scene::Scene& scene, const pipeline::LightmapPages& lightmaps,
                         std::span<const std::vector<Vec2>> light_uv) {
  std::vector<DensityShare> shares;
  for (const scene::Instance& instance : scene.instances)
    add_densities(scene.meshes[instance.mesh], instance.world_from_object,
                  places_of(scene, instance.mesh, light_uv), lightmaps, shares);
  std::sort(shares.begin(), shares.end(),
            [](const DensityShare& a, const DensityShare& b) { return a.per_metre < b.per_metre; });
  const float low = density_below(shares, 0.01), high = density_below(shares, 0.99);
  const float wider = std::max(1.0f, 2 / std::sqrt(high / low));
  return {low / wider, high * wider, true};
}

Rgb light_at(const image::HalfImage& page, Vec2 uv) {
  const display::BilinearTexels texels = display::bilinear_texels(page.width, page.height, uv);
  Rgb sum{};
  for (size_t k = 0; k < 4; ++k) {
    const auto [x, y] = texels.texel[k];
    const uint16_t* at =
        page.data.data() + size_t(page.channels) * (size_t(y) * size_t(page.width) + size_t(x));
    sum += Rgb{image::from_half(at[0]), image::from_half(at[1]), image::from_half(at[2])} *
           (page.scale * texels.weight[k]);
  }
  return sum;
}

/// White pixels, which stand for no texel, become what is beside them: at the rim of a chart
/// surfaces reach half a texel beyond the last one.
image::Image8 without_white_rim(const image::Image8& from) {
  image::Image8 out = from;
  const auto pixel = [&](int x, int y) {
    const size_t i = 4 * (size_t(y) * size_t(from.width) + size_t(x));
    return std::span(from.data).subspan(i, 4);
  };
  const auto is_white = [](std::span<const uint8_t> p) {
    return p[0] == 255 && p[1] == 255 && p[2] == 255;
  };
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x)
      for (const auto& [dx, dy] : kAround) {
        if (!is_white(pixel(x, y))) break;
        const int ox = x + dx, oy = y + dy;
        if (ox < 0 || oy < 0 || ox >= from.width || oy >= from.height) continue;
        const auto other = pixel(ox, oy);
        if (is_white(other)) continue;
        const size_t i = 4 * (size_t(y) * size_t(from.width) + size_t(x));
        std::copy(other.begin(), other.end(), out.data.begin() + std::ptrdiff_t(i));
        break;
      }
  return out;
}

/// NAME.png beside each lightmap.exr, NAME-1.png beside lightmap-1.exr; none where one is not
/// there.
Result<std::vector<image::Image8>> texel_pictures(const std::filesystem::path& folder,
                                                  const std::string& name,
                                                  const pipeline::LightmapPages& lightmaps) {
  const auto beside = [&](const std::filesystem::path& lightmap) {
    const std::string number = lightmap.stem().string().substr(std::string("lightmap").size());
    return folder / (name + number + ".png");
  };
  bool is_there = true;
  const auto read = [&](const std::filesystem::path& lightmap) -> Result<image::Image> {
    std::error_code ignored;
    is_there &= std::filesystem::exists(beside(lightmap), ignored);
    if (!is_there) return image::Image();
    LUXEL_TRY(const std::vector<std::byte> bytes, read_file(beside(lightmap)));
    return image::decode_display(bytes, beside(lightmap).string());
  };
  LUXEL_TRY(const pipeline::LightmapPages pages,
            pipeline::read_pages(folder, lightmaps.of_material.size(), read));
  std::vector<image::Image8> out;
  if (!is_there) return out;
  for (size_t i = 0; i < pages.pictures.size(); ++i) {
    const image::Image& from = pages.pictures[i];
    const image::Image& page = lightmaps.pictures[i];
    if (from.width != page.width || from.height != page.height)
      return fail(
          ErrorCode::bad_input,
          "{} of {} has {} x {} pixels and the lightmap {} x {}: they belong to different bakes",
          name, folder.string(), from.width, from.height, page.width, page.height);
    image::Image8 picture{from.width, from.height, 4, {}};
    for (const float v : from.data) picture.data.push_back(uint8_t(std::lround(v * 255)));
    out.push_back(without_white_rim(picture));
  }
  return out;
}

}  // namespace

Look look_at(const scene::Scene& scene, const pipeline::LightmapPages& lightmaps,
             std::span<const std::vector<Vec2>> light_uv) {
  Look out;
  out.irradiance = irradiance_scale(lightmaps);
  out.density = density_scale(scene, lightmaps, light_uv);
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    out.charts.push_back(charts_of(scene.meshes[m], places_of(scene, m, light_uv)));
    out.chart_count += out.charts.back().charts;
  }
  out.overlaps = uv_overlaps(scene, lightmaps, light_uv);
  return out;
}

Result<Look> look_into(const std::filesystem::path& folder, const scene::Scene& scene,
                       const pipeline::LightmapPages& lightmaps) {
  Look out = look_at(scene, lightmaps);
  LUXEL_TRY(out.texels, texel_pictures(folder, "texels", lightmaps));
  LUXEL_TRY(out.errors, texel_pictures(folder, "error", lightmaps));
  return out;
}

std::optional<std::string> missing_for(Show show, const Look& look, const std::string& folder) {
  const bool is_texels = show == Show::texels && look.texels.empty();
  const bool is_error = show == Show::error && look.errors.empty();
  if (!is_texels && !is_error) return std::nullopt;
  const std::string file = is_texels ? "texels.png" : "error.png";
  const std::string option = is_texels ? "--texels" : "--error-map";
  if (folder.empty())
    return fmt::format("{} is written by bakes with {}; open the folder of one", file, option);
  return fmt::format("{}: there is no {} in it; bake with {}", folder, file, option);
}

ColorScale scale_of(const ColorScale& own, const ColorScale& of_bake) {
  ColorScale out = own;
  if (!(own.high > own.low)) {
    out.low = of_bake.low, out.high = of_bake.high;
    out.is_logarithmic |= of_bake.is_logarithmic;
  }
  if (out.is_logarithmic && !(out.low > 0)) out.low = out.high * kLowestOfLogarithm;
  return out;
}

std::array<uint32_t, 256> packed_false_colors() {
  std::array<uint32_t, 256> out{};
  for (size_t i = 0; i < out.size(); ++i) {
    const image::Color8 c = image::false_color(double(i) / 255);
    out[i] = uint32_t(c[0]) | uint32_t(c[1]) << 8 | uint32_t(c[2]) << 16;
  }
  return out;
}

std::optional<Legend> legend_of(const Frame& frame, const Look& look) {
  if (frame.beside && frame.beside->mode == BesideMode::difference)
    return Legend{"difference, over the mean", "", {0, kMostDifference, false}};
  if (frame.beside && frame.beside->mode == BesideMode::flip)
    return Legend{"FLIP", "", {0, 1, false}};
  if (frame.show == Show::irradiance) {
    const bool is_whole = frame.channel == Channel::luminance;
    const std::string channel =
        is_whole ? "" : fmt::format(", {}", kChannels[size_t(frame.channel)]);
    return Legend{"irradiance" + channel, look.unit, scale_of(frame.irradiance, look.irradiance)};
  }
  if (frame.show == Show::density)
    return Legend{"density", "texels per m", scale_of(frame.density, look.density)};
  if (frame.show == Show::error && !look.errors.empty())
    return Legend{
        "relative standard error", "", {pipeline::kLowestError, pipeline::kHighestError, true}};
  return std::nullopt;
}

float value_of(Rgb light, Channel channel) {
  return channel == Channel::luminance ? luminance(light) : light[int(channel)];
}

std::optional<float> value_at(const Frame& frame, const scene::Scene& scene,
                              const pipeline::LightmapPages& lightmaps,
                              const scene::SurfacePoint& point) {
  const scene::Instance& instance = scene.instances[point.instance];
  const scene::Mesh& mesh = scene.meshes[instance.mesh];
  const image::Image& page = lightmaps.of(scene, point);
  if (mesh.uv1.empty()) return std::nullopt;
  if (frame.show == Show::irradiance)
    return value_of(display::lightmap_at(scene, page, point), frame.channel);
  if (frame.show == Show::density)
    return density_of(mesh, point.triangle, instance.world_from_object, mesh.uv1, page).per_metre;
  return std::nullopt;
}

std::optional<float> value_at(const Frame& frame, const LitScene& lit,
                              std::span<const image::HalfImage> pages,
                              const scene::SurfacePoint& point) {
  if (point.instance >= lit.scene.instances.size()) return std::nullopt;
  const scene::Instance& instance = lit.scene.instances[point.instance];
  const scene::Mesh& mesh = lit.scene.meshes[instance.mesh];
  if (point.triangle >= mesh.triangles.size()) return std::nullopt;
  const size_t number = lit.page_of_material[mesh.triangle_material[point.triangle]];
  if (number >= pages.size()) return std::nullopt;
  const image::HalfImage& page = pages[number];
  const std::vector<Vec2>& places = lit.light_uv[instance.mesh];
  if (frame.show == Show::irradiance) {
    const auto& t = mesh.triangles[point.triangle];
    const Vec2 uv = interpolate(places[t[0]], places[t[1]], places[t[2]], point.at);
    return value_of(light_at(page, uv), frame.channel);
  }
  if (frame.show != Show::density) return std::nullopt;
  image::Image sized;  // only its size counts
  sized.width = page.width, sized.height = page.height;
  return density_of(mesh, point.triangle, instance.world_from_object, places, sized).per_metre;
}

}  // namespace luxel::view
