#include "luxel/export/view_page.h"

#include <zlib.h>

#include <nlohmann/json.hpp>

#include "luxel/base/base64.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/shown_text.h"
#include "luxel/export/baked_glb.h"
#include "luxel/export/json_parts.h"
#include "luxel/export/small_picture.h"
#include "luxel/export/view_template.h"
#include "luxel/image/half.h"
#include "luxel/scene/origin.h"

namespace luxel::export_ {
namespace {

using nlohmann::json;

/// As the browser's DecompressionStream("deflate") reads it. [RFC 1950]
Result<std::vector<std::byte>> deflated(std::span<const std::byte> bytes) {
  uLongf size = compressBound(uLong(bytes.size()));
  std::vector<std::byte> out(size);
  const int status = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), uLong(bytes.size()),
                               Z_DEFAULT_COMPRESSION);
  if (status != Z_OK)
    return fail(ErrorCode::out_of_memory, "no memory is left to pack {} bytes for view.html",
                bytes.size());
  out.resize(size);
  return out;
}

/// A script element that no browser runs. JSON and base64 hold no '<' that could end it: json's own
/// are written as escapes.
void append_data(std::string& html, const char* id, const char* type, std::string_view text) {
  html += fmt::format("<script id=\"{}\" type=\"{}\">", id, type);
  for (const char c : text) {
    if (c == '<')
      html += "\\u003c";
    else
      html += c;
  }
  html += "</script>\n";
}

/// Bytes as the page inflates them again.
Status append_packed(std::string& html, const std::string& id, std::span<const std::byte> bytes) {
  LUXEL_TRY(const std::vector<std::byte> packed, deflated(bytes));
  append_data(html, id.c_str(), "text/plain", base64(packed));
  return {};
}

/// An image as 16-bit floats, packed, and what they mean.
struct PackedImage {
  json about;
  std::vector<std::byte> bytes;
};

Result<PackedImage> packed_image(const std::string& id, const image::Image& image) {
  const image::HalfImage half = image::to_half(image);
  PackedImage out;
  LUXEL_TRY(out.bytes, deflated(std::as_bytes(std::span(half.data))));
  out.about = {{"id", id}, {"width", half.width}, {"height", half.height}, {"scale", half.scale}};
  return out;
}

/// Says what the image means.
json append_image(std::string& html, PackedImage image) {
  append_data(html, image.about["id"].get<std::string>().c_str(), "text/plain",
              base64(image.bytes));
  return std::move(image.about);
}

/// Pages of the lightmap; with layers their pictures stand in for its own.
Result<json> append_lightmaps(std::string& html, std::span<const image::Image> lightmaps,
                              bool with_pictures) {
  json out = json::array();
  for (size_t p = 0; p < lightmaps.size(); ++p) {
    json page = {{"width", lightmaps[p].width}, {"height", lightmaps[p].height}};
    if (with_pictures) {
      LUXEL_TRY(PackedImage image, packed_image(fmt::format("light-{}", p), lightmaps[p]));
      page = append_image(html, std::move(image));
    }
    page["file"] = lightmap_name(p, lightmaps.size()) + ".exr";  // by which materials name it
    out.push_back(std::move(page));
  }
  return out;
}

/// Names of the layers; to `pages` comes the picture of each layer there, in their order.
Result<json> append_layers(std::string& html, std::span<const LightmapLayer> layers, json& pages) {
  json out = json::array();
  std::vector<Result<PackedImage>> packed(layers.size());
  for (size_t p = 0; p < pages.size(); ++p) {
    parallel_for(layers.size(), 1, [&](size_t l, size_t) {
      packed[l] = packed_image(fmt::format("light-{}-{}", p, l), layers[l].lightmaps[p]);
    });
    for (size_t l = 0; l < layers.size(); ++l) {
      LUXEL_TRY(PackedImage image, std::move(packed[l]));
      array_in(pages[p], "layers").push_back(append_image(html, std::move(image)));
    }
  }
  for (const LightmapLayer& layer : layers)
    out.push_back(
        {{"name", layer.name}, {"lights", layer.lights}, {"surroundings", layer.surroundings}});
  return out;
}

Result<json> append_surroundings(std::string& html, const scene::Environment* map) {
  if (!map || map->empty()) return nullptr;
  LUXEL_TRY(PackedImage image,
            packed_image("surroundings", small_picture(*map, kSurroundingsWidth)));
  json out = append_image(html, std::move(image));
  out["rotation"] = map->rotation_rad;
  return out;
}

}  // namespace

json to_json(const View& view, DVec3 origin) {
  json matrix = json::array();
  for (size_t j = 0; j < 3; ++j) {
    for (size_t i = 0; i < 3; ++i) matrix.push_back(view.camera.world_from_camera.row[i][j]);
    matrix.push_back(0);
  }
  const DVec3 place = scene::in_world(origin, column(view.camera.world_from_camera, 3));
  matrix.insert(matrix.end(), {place.x, place.y, place.z, 1});
  return {{"width", view.width},
          {"height", view.height},
          {"exposure", view.exposure},
          {"camera",
           {{"matrix", std::move(matrix)},
            {"yfov", view.camera.fov_y_rad},
            {"aspect", view.camera.aspect},
            {"height_m", view.camera.orthographic_height_m}}}};
}

std::optional<View> view_of_json(const json& from, DVec3 origin) {
  try {
    View out;
    from.at("width").get_to(out.width);
    from.at("height").get_to(out.height);
    from.at("exposure").get_to(out.exposure);
    const json& camera = from.at("camera");
    const auto matrix = camera.at("matrix").get<std::vector<double>>();
    if (matrix.size() != 16) return std::nullopt;
    for (size_t i = 0; i < 12; ++i)
      out.camera.world_from_camera.row[i / 4][i % 4] = float(matrix[4 * (i % 4) + i / 4]);
    const Vec3 place = to_float(DVec3{matrix[12], matrix[13], matrix[14]} - origin);
    for (int i = 0; i < 3; ++i) out.camera.world_from_camera.row[size_t(i)][3] = place[i];
    camera.at("yfov").get_to(out.camera.fov_y_rad);
    camera.at("aspect").get_to(out.camera.aspect);
    camera.at("height_m").get_to(out.camera.orthographic_height_m);
    const bool makes_sense = out.width > 0 && out.height > 0 && out.exposure > 0 &&
                             std::isfinite(out.exposure) && out.camera.aspect >= 0 &&
                             out.camera.fov_y_rad > 0 && out.camera.fov_y_rad < kPi;
    return makes_sense ? std::optional(out) : std::nullopt;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

Status check_view_page() {
  if (!view_page_before_data().empty()) return {};
  return fail(ErrorCode::bad_setting,
              "this luxel has no --html, because it was built without node, npm or a network; "
              "install nodejs and npm, run make build with a network, and bake again");
}

Result<std::string> view_html(const ViewPage& page) {
  LUXEL_CHECK(!page.lightmaps.empty());
  for (const image::Image& lightmap : page.lightmaps) LUXEL_CHECK(lightmap.channels == 4);
  for (const LightmapLayer& layer : page.layers)
    LUXEL_CHECK(layer.lightmaps.size() == page.lightmaps.size());
  LUXEL_TRY_STATUS(check_view_page());
  std::string html(view_page_before_data());
  json about = {{"title", page.title},
                {"triangles", page.triangles},
                {"background", {page.background.x, page.background.y, page.background.z}},
                {"preview", to_json(page.view)}};
  LUXEL_TRY(about["light"], append_lightmaps(html, page.lightmaps, page.layers.empty()));
  if (!page.layers.empty()) {
    LUXEL_TRY(about["layers"], append_layers(html, page.layers, about["light"]));
  }
  LUXEL_TRY(about["surroundings"], append_surroundings(html, page.environment));
  LUXEL_TRY_STATUS(append_packed(html, "model", page.glb));
  append_data(html, "about", "application/json", json_text(about));
  html += view_page_after_data();
  return html;
}

}  // namespace luxel::export_
