#include "luxel/view/model/bounced_light.h"

#include <algorithm>

#include "luxel/base/parallel.h"

namespace luxel::view {
namespace {

constexpr size_t kFloatsPerPart = 1 << 14;

/// a - b, but no less than nothing; alpha stays.
void subtract(const image::HalfImage& b, image::Image& a) {
  const auto channels = size_t(a.channels), channels_b = size_t(b.channels);
  parallel_for(a.data.size(), kFloatsPerPart, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t c = i % channels;
      if (c == 3) continue;
      const float less = image::from_half(b.data[i / channels * channels_b + c]) * b.scale;
      a.data[i] = std::max(a.data[i] - less, 0.0f);
    }
  });
}

/// True: both pictures have light at the same texels.
bool lies_alike(const image::Image& a, const image::Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) return false;
  for (size_t i = 3; a.channels == 4 && i < a.data.size(); i += 4)
    if (a.data[i] != b.data[i]) return false;
  return true;
}

/// The pages of one of the bakes. `page`: lightmap.exr, or those that the materials name.
Result<PagesOfHalves> read_after(const std::filesystem::path& folder,
                                 const std::filesystem::path& of,
                                 const pipeline::LightmapPages& lightmaps) {
  LUXEL_TRY(const pipeline::LightmapPages pages,
            pipeline::read_pages(folder, lightmaps.of_material.size(),
                                 [&](const std::filesystem::path& file) {
                                   return pipeline::read_lightmap(of / file.filename());
                                 }));
  PagesOfHalves out;
  for (size_t i = 0; i < pages.pictures.size(); ++i) {
    if (!lies_alike(pages.pictures[i], lightmaps.pictures[i]))
      return fail(ErrorCode::bad_input,
                  "the lightmap of {} has another layout than that of {}: bake both with the same "
                  "options, except for --bounces and --output",
                  of.string(), folder.string());
    out.push_back(image::to_half(pages.pictures[i]));
  }
  return out;
}

}  // namespace

image::Image to_floats(const image::HalfImage& from) {
  image::Image out(from.width, from.height, from.channels);
  for (size_t i = 0; i < out.data.size(); ++i) {
    const bool is_alpha = from.channels == 4 && i % 4 == 3;
    out.data[i] = image::from_half(from.data[i]) * (is_alpha ? 1 : from.scale);
  }
  return out;
}

Result<std::vector<image::Image>> part_of(const LightShown& light, const BouncedLight& bounced,
                                          std::span<const image::Image> all) {
  const size_t known = bounced.after.size(), needed = light.most ? *light.most + 1 : light.fewest;
  if (needed > known)
    return fail(ErrorCode::bad_setting,
                "light of {} bounces is not known separately, only up to {}", needed - 1,
                known - 1);
  std::vector<image::Image> out;
  for (size_t page = 0; page < all.size(); ++page) {
    out.push_back(light.most ? to_floats(bounced.after[*light.most][page]) : all[page]);
    if (light.fewest > 0) subtract(bounced.after[light.fewest - 1][page], out.back());
  }
  return out;
}

Result<BouncedLight> read_bounced(const std::filesystem::path& folder,
                                  const pipeline::LightmapPages& lightmaps) {
  BouncedLight out;
  std::error_code ignored;
  for (uint32_t n = 0; n <= kMostBounces; ++n) {
    const std::filesystem::path of = folder / fmt::format("bounces-{}", n);
    if (!std::filesystem::exists(of, ignored)) break;
    LUXEL_TRY(PagesOfHalves pages, read_after(folder, of, lightmaps));
    out.after.push_back(std::move(pages));
  }
  if (out.after.empty())
    return fail(ErrorCode::bad_input,
                "{0} holds all bounces together; to see them separately, run `luxel bake SCENE -o "
                "{0}/bounces-0 --bounces 0` with the other options of that bake, then the same "
                "with 1 for 0, and so on",
                folder.string());
  return out;
}

std::string words_of(const LightShown& light) {
  for (const PartName& part : kParts)
    if (part.light == light) return part.words;
  if (!light.most) return fmt::format("after {} or more bounces", light.fewest);
  if (light.fewest == *light.most) return fmt::format("of bounce {} only", *light.most);
  return fmt::format("up to {} bounce{}", *light.most, *light.most == 1 ? "" : "s");
}

}  // namespace luxel::view
