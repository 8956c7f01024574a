#include "luxel/solve/device/gather_device.h"

#include <optional>

#include "luxel/base/check.h"
#include "luxel/light/device/direct_light_on_device.h"
#include "luxel/solve/device/device_sweep.h"
#include "luxel/solve/device/landed_rays.h"
#include "luxel/solve/gather/bounce/sweep.h"

namespace luxel::device {
namespace {

class GatherDevice final : public gather::RayDevice {
 public:
  explicit GatherDevice(const gpu::Device& device) : device_(&device) {}

  Status begin(const gather::TraceScene& in) override {
    forget();
    if (in.tracer.has_tints())
      return fail(ErrorCode::unsupported,
                  "the device cannot trace rays through coloured glass, which the scene has: bake "
                  "it on the processor");
    LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(*device_));
    commands_.emplace(std::move(commands));
    LUXEL_TRY(trace::DeviceRayTracer tracer, trace::DeviceRayTracer::build(*device_, in.scene));
    tracer_.emplace(std::move(tracer));
    return {};
  }

  Result<light::LightDevice*> light_device(const gather::TraceScene& in) override {
    LUXEL_CHECK(tracer_);
    if (!device_->has_doubles || !light::device_knows(in.scene, in.lights)) return nullptr;
    LUXEL_TRY(light::DeviceDirectLight direct,
              light::DeviceDirectLight::make(*tracer_, *commands_, in.scene, in.lights));
    return &direct_.emplace(std::move(direct));
  }

  Status trace(const gather::TraceScene& in, std::span<const uint16_t> target,
               const gather::TraceParams& params, gather::TracedHits& hits,
               Progress& progress) override {
    LUXEL_CHECK(tracer_);
    const DeviceScene scene{*tracer_, *commands_, in, direct_ ? &*direct_ : nullptr};
    if (hits.rounds.empty()) {
      rays_.reset();
      LUXEL_TRY(LandedRays rays, begin_rays(scene, params));
      rays_.emplace(std::move(rays));
      gathered_.resize(in.elements.size());
    }
    LandedSeconds seconds;
    return land_round(scene, target, {}, params, *rays_, hits, seconds, progress);
  }

  Status sweep(const gather::RadiosityMap& map, std::span<gather::Gathered> out) override {
    LUXEL_CHECK(rays_ && out.size() == gathered_.size());
    LUXEL_TRY([[maybe_unused]] const double seconds,
              device::sweep(*commands_, *rays_, map, gathered_));
    for (size_t i = 0; i < out.size(); ++i) {
      const on_device::Gathered& g = gathered_[i];
      out[i].sum = gather::Float4{g.sum.x, g.sum.y, g.sum.z, 0};
      out[i].sum_luminance2 = g.sum_luminance2, out[i].first_less_second = g.first_less_second;
    }
    return {};
  }

  void forget() override { rays_.reset(), direct_.reset(), tracer_.reset(), gathered_.clear(); }

 private:
  const gpu::Device* device_;
  std::optional<gpu::Commands> commands_;
  std::optional<trace::DeviceRayTracer> tracer_;    ///< of the last begin()
  std::optional<light::DeviceDirectLight> direct_;  ///< goes before tracer_
  std::optional<LandedRays> rays_;                  ///< of the last trace(); goes before commands_
  std::vector<on_device::Gathered> gathered_;
};

}  // namespace

std::unique_ptr<gather::RayDevice> gather_device(const gpu::Device& device) {
  return std::make_unique<GatherDevice>(device);
}

}  // namespace luxel::device
