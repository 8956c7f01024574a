#include "luxel/solve/gather/reuse/earlier_direct.h"

#include "luxel/base/check.h"
#include "luxel/light/reach.h"
#include "luxel/transport/texel_width.h"

namespace luxel::gather {
namespace {

/// Reach of an element's lit points around its position, in widths of a texel: the points of
/// supersampling lie all over its texel, and its own sample anywhere in it.
constexpr float kTexelReach = 1.5f;

bool shines(const light::Lights& lights) {
  return !lights.punctual.empty() || !lights.triangles.empty();
}

Status add_changed_lights(const light::TexelScene& in, const light::SupersampleParams& params,
                          Earlier& earlier, Progress& progress) {
  light::SupersampleParams alone = params;
  alone.direct.layers = nullptr;
  LUXEL_TRY(light::DirectLight light,
            light::direct_light(in.scene, in.elements, earlier.changed_lights, in.tracer,
                                alone.direct, progress));
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(
                {in.scene, in.atlas, in.map, in.elements, earlier.changed_lights, in.tracer}, alone,
                light, progress));
  light::DirectLight& all = earlier.direct;
  for (size_t i = 0; i < all.irradiance.size(); ++i) {
    all.irradiance[i] += light.irradiance[i];
    all.variance[i] += light.variance[i], all.split_variance[i] += light.split_variance[i];
  }
  for (const uint32_t i : averaged.texels) earlier.levels.averaged[i] = 1;
  all.rays += light.rays + averaged.rays;
  return {};
}

/// Elements whose direct light may be another; and notes near which it is not.
std::vector<uint32_t> touched(const light::TexelScene& in, EarlierRays& rays) {
  std::vector<float>& reach_m = rays.same_light_m;
  reach_m.resize(in.elements.size());
  for (size_t i = 0; i < reach_m.size(); ++i) {
    const scene::SurfacePoint& p = in.map.texels[i].sample;
    reach_m[i] = kTexelReach * transport::texel_width_m(in.scene, in.atlas, p.instance, p.triangle);
  }
  const std::vector<uint8_t> reached =
      light::elements_in_reach(in.scene, in.elements, reach_m, in.lights, rays.boxes);
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < reached.size(); ++i) {
    if (reached[i]) reach_m[i] = -1;
    if (reached[i] || rays.moved[i]) out.push_back(i);
  }
  return out;
}

}  // namespace

Status update_direct(const light::TexelScene& in, const light::SupersampleParams& params,
                     Earlier& earlier, Progress& progress) {
  LUXEL_CHECK(earlier.direct.irradiance.size() == in.elements.size());
  LUXEL_CHECK(earlier.rays.moved.size() == in.elements.size());
  earlier.direct.rays = 0;
  if (shines(earlier.changed_lights)) {
    LUXEL_CHECK(params.direct.layers == nullptr);
    LUXEL_TRY_STATUS(add_changed_lights(in, params, earlier, progress));
  }
  const std::vector<uint32_t> which = touched(in, earlier.rays);
  if (which.empty()) return {};
  for (const uint32_t i : which) earlier.levels.level[i] = earlier.levels.averaged[i] = 0;
  LUXEL_TRY_STATUS(light::direct_light_again(light::lit_elements(in), which, params.direct,
                                             earlier.direct, progress));
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(in, which, params, earlier.direct, progress));
  earlier.direct.rays += averaged.rays;
  for (const uint32_t i : averaged.texels) earlier.levels.averaged[i] = 1;
  return {};
}

}  // namespace luxel::gather
