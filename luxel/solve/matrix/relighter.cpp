#include "luxel/solve/matrix/relighter.h"

#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <tuple>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/codec.h"
#include "luxel/solve/matrix/live_light.h"

namespace luxel::matrix {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

/// B_e of a patch whose material's mean radiosity is to be `wanted` and was `mean`.
Rgb emission_of(Rgb baked, Rgb mean, Rgb wanted) {
  const auto channel = [](float own, float was, float is) { return was > 0 ? own / was * is : is; };
  return {channel(baked.x, mean.x, wanted.x), channel(baked.y, mean.y, wanted.y),
          channel(baked.z, mean.z, wanted.z)};
}

}  // namespace

namespace {

/// Lamps whose light is kept: of one that is dragged among others, theirs is not asked for again.
constexpr size_t kMostKept = 16;

/// All that the light of a lamp depends on.
auto key_of(const scene::PunctualLight& l) {
  return std::make_tuple(l.kind, l.intensity, l.position, l.direction, l.range_m, l.inner_cone_rad,
                         l.outer_cone_rad);
}

}  // namespace

struct Relighter::Impl {
  struct KeptLight {
    std::optional<decltype(key_of({}))> of;  ///< nothing: no lamp yet
    std::vector<Rgb> direct;                 ///< E per patch
  };

  RelightData data;
  RelighterParams params;
  scene::Scene occluders;  ///< stays where it is: the tracer refers to it
  std::optional<trace::RayTracer> tracer;
  std::vector<Rgb> mean_emission;  ///< B_e per material, as baked
  std::vector<Vec3> probe_position, probe_normal;

  std::array<KeptLight, kMostKept> kept;  ///< of the first lamps
  CodecScratch scratch;
  std::vector<Rgb> at_probe, at_patch, sent;
  std::vector<Rgb> straight;   ///< E per patch from the background and, where it is kept, the glow
  std::vector<Rgb> radiosity;  ///< of its own, per material

  // Three results: one is written, one is read, and the third is the latest complete one, which
  // either side exchanges for its own. `middle` is its number, with kFresh while nobody has read
  // it.
  static constexpr uint32_t kFresh = 4;
  std::array<Relit, 3> result;
  uint32_t back = 0, front = 1;
  std::atomic<uint32_t> middle{2};
  uint64_t updates = 0;
  Seconds seconds;

  void make_room();
  void light_patches(std::span<const Rgb> of_probes, std::span<Rgb> patches) const;
  void shine(std::span<const scene::PunctualLight> lights, std::span<Rgb> patches);
  void direct_light(const RelightLights& lights, Relit& out);
  void bounces(const RelightLights& lights, Relit& out);
  void light_places(const RelightLights& lights, Relit& out);
};

void Relighter::Impl::make_room() {
  mean_emission = mean_emission_of(data);
  for (const PatchPoint& p : data.probe)
    probe_position.push_back(p.position), probe_normal.push_back(p.normal);
  scratch = make_scratch(data.codec, data.size());
  at_probe.resize(data.probe.size()), at_patch.resize(data.size());
  sent.resize(data.size()), straight.resize(data.size());
  for (KeptLight& light : kept) light.direct.resize(data.size());
  radiosity.resize(mean_emission.size());
  const size_t places = data.target.position.size();
  for (Relit& r : result) {
    r.direct.resize(data.size()), r.indirect.resize(data.size());
    r.indirect_at_points.resize(places);
    r.direct_at_points.resize(params.direct_at_points ? places : 0);
  }
}

/// A patch gets the mean of its probes.
void Relighter::Impl::light_patches(std::span<const Rgb> of_probes, std::span<Rgb> patches) const {
  for (size_t i = 0; i < data.size(); ++i) {
    Rgb sum{};
    for (uint32_t k = data.first_probe[i]; k < data.first_probe[i + 1]; ++k) sum += of_probes[k];
    patches[i] = sum / std::max(1.0f, float(data.first_probe[i + 1] - data.first_probe[i]));
  }
}

/// By shadow rays.
void Relighter::Impl::shine(std::span<const scene::PunctualLight> lights, std::span<Rgb> patches) {
  live_light({probe_position, probe_normal, probe_normal}, lights, *tracer, at_probe);
  light_patches(at_probe, patches);
}

void Relighter::Impl::direct_light(const RelightLights& lights, Relit& out) {
  if (!lights.direct_at_probes.empty()) return light_patches(lights.direct_at_probes, out.direct);
  std::fill(out.direct.begin(), out.direct.end(), Rgb{});
  const auto add = [&](std::span<const Rgb> light) {
    for (size_t i = 0; i < light.size(); ++i) out.direct[i] += light[i];
  };
  const size_t single = std::min(lights.punctual.size(), kMostKept);
  for (size_t k = 0; k < single; ++k) {
    const auto key = key_of(lights.punctual[k]);
    if (kept[k].of != key) shine(lights.punctual.subspan(k, 1), kept[k].direct);
    kept[k].of = key;
    add(kept[k].direct);
  }
  if (single == lights.punctual.size()) return;
  shine(lights.punctual.subspan(single), at_patch);
  add(at_patch);
}

void Relighter::Impl::bounces(const RelightLights& lights, Relit& out) {
  for (size_t m = 0; m < radiosity.size(); ++m)
    radiosity[m] = lights.emission.empty() ? mean_emission[m] : lights.emission[m] * kPi;
  for (size_t i = 0; i < data.size(); ++i) straight[i] = lights.background * (kPi * data.sky[i]);
  const bool glow_is_kept = !data.glow.first.empty();
  if (glow_is_kept) add_glow(data.glow, radiosity, straight);
  for (size_t i = 0; i < data.size(); ++i) {
    const uint32_t m = data.material[i];
    sent[i] = data.reflectance[i] * (out.direct[i] + straight[i]);
    if (!glow_is_kept) sent[i] += emission_of(data.emission[i], mean_emission[m], radiosity[m]);
  }
  irradiance_of(data.codec, {sent, data.reflectance, data.area_m2, data.bounces}, out.indirect,
                scratch);
  for (size_t i = 0; i < data.size(); ++i) out.indirect[i] += straight[i];
}

void Relighter::Impl::light_places(const RelightLights& lights, Relit& out) {
  const Target& to = data.target;
  transfer(to.transfer, out.indirect, out.indirect_at_points);
  if (params.direct_at_points)
    live_light({to.position, to.normal, to.geometric_normal}, lights.punctual, *tracer,
               out.direct_at_points);
}

Relighter::Relighter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Relighter::Relighter(Relighter&&) noexcept = default;
Relighter& Relighter::operator=(Relighter&&) noexcept = default;
Relighter::~Relighter() = default;

Result<Relighter> Relighter::make(RelightData data, const RelighterParams& params) {
  auto impl = std::make_unique<Impl>();
  impl->data = std::move(data), impl->params = params;
  impl->occluders = scene_of(impl->data.occluders);
  LUXEL_TRY(impl->tracer, trace::RayTracer::build(impl->occluders));
  impl->make_room();
  return Relighter(std::move(impl));
}

const RelightData& Relighter::data() const { return impl_->data; }
Relighter::Seconds Relighter::seconds() const { return impl_->seconds; }

void Relighter::update(const RelightLights& lights) {
  Impl& my = *impl_;
  LUXEL_CHECK(lights.emission.empty() || lights.emission.size() == my.data.material_name.size());
  LUXEL_CHECK(lights.direct_at_probes.empty() ||
              lights.direct_at_probes.size() == my.data.probe.size());
  Relit& out = my.result[my.back];
  const Clock::time_point start = Clock::now();
  my.direct_light(lights, out);
  const Clock::time_point direct = Clock::now();
  my.bounces(lights, out);
  const Clock::time_point bounced = Clock::now();
  my.light_places(lights, out);
  my.seconds = {seconds_between(start, direct), seconds_between(direct, bounced),
                seconds_between(bounced, Clock::now())};
  out.update = ++my.updates;
  // Release: the reader sees all of `out`. Acquire: its last look at what comes back is over.
  my.back = my.middle.exchange(my.back | Impl::kFresh, std::memory_order_acq_rel) & ~Impl::kFresh;
}

const Relit& Relighter::latest() {
  Impl& my = *impl_;
  if (my.middle.load(std::memory_order_relaxed) & Impl::kFresh)
    my.front = my.middle.exchange(my.front, std::memory_order_acq_rel) & ~Impl::kFresh;
  return my.result[my.front];
}

}  // namespace luxel::matrix
