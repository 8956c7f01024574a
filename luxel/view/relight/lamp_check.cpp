#include "luxel/view/relight/lamp_check.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "luxel/base/random.h"
#include "luxel/base/thread_priority.h"

namespace luxel::view {
namespace {

/// Texels, and the light that they have.
struct CheckedTexels {
  std::vector<Vec3> position, normal, geometric_normal;
  std::vector<Rgb> indirect;
};

/// Texels are of about one size: by chance, so many of those that patches light.
CheckedTexels texels_to_check(RelitLight& light, const LampCheckParams& params) {
  const matrix::Target& target = light.relighter.data().target;
  const std::vector<Rgb>& indirect = light.relighter.latest().indirect_at_points;
  const std::vector<uint32_t>& lit = light.places.place;
  CheckedTexels out;
  for (size_t k = 0; k < params.places && !lit.empty(); ++k) {
    const uint32_t place = lit[hash64(params.seed, k) % lit.size()];
    out.position.push_back(target.position[place]), out.normal.push_back(target.normal[place]);
    out.geometric_normal.push_back(target.geometric_normal[place]);
    out.indirect.push_back(indirect[place]);
  }
  return out;
}

class CheckThread : public LampCheck {
 public:
  CheckThread(std::shared_ptr<const ReadScene> read, CheckedTexels texels, int bounces, Lamps baked,
              Lamps now, const LampCheckParams& params)
      : read_(std::move(read)),
        texels_(std::move(texels)),
        bounces_(bounces),
        baked_(std::move(baked)),
        now_(std::move(now)),
        params_(params),
        thread_([this] { work(); }) {}
  ~CheckThread() override {
    progress_.request_cancel();
    thread_.join();
  }

  float share() const override { return std::max(0.0f, float(progress_.snapshot().share)); }
  std::optional<Result<pipeline::IndirectError>> result() const override {
    const std::scoped_lock lock(mutex_);
    return result_;
  }
  void wait() override {
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return result_.has_value(); });
  }

 private:
  void work() {
    lower_priority_of_this_thread();
    Result<pipeline::IndirectError> found = measured();
    const std::scoped_lock lock(mutex_);
    result_ = std::move(found);
    ended_.notify_all();
  }
  Result<pipeline::IndirectError> measured() try {
    scene::Scene scene = read_->scene;
    scene.lights = shining(now_), scene.background = now_.background;
    for (scene::Material& m : scene.materials) m.emission = emission_now(m, now_, baked_);
    progress_.expect(pipeline::stages_of_indirect_error(scene.lights.size()));
    return pipeline::indirect_error(
        {scene,
         *read_->tracer,
         {texels_.position, texels_.normal, texels_.geometric_normal, {}},
         texels_.indirect,
         bounces_},
        params_.paths, params_.seed, progress_);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, "out of memory");
  }

  const std::shared_ptr<const ReadScene> read_;
  const CheckedTexels texels_;
  const int bounces_;
  const Lamps baked_, now_;
  const LampCheckParams params_;
  Progress progress_;
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  std::optional<Result<pipeline::IndirectError>> result_;  ///< under the mutex
  std::thread thread_;                                     ///< the last: it uses all of the others
};

}  // namespace

std::unique_ptr<LampCheck> LampCheck::begin(OpenedLxr& opened, const Lamps& now,
                                            const LampCheckParams& params) {
  relight(now, opened.light);
  return std::make_unique<CheckThread>(opened.read, texels_to_check(opened.light, params),
                                       opened.light.relighter.data().bounces, opened.lamps, now,
                                       params);
}

std::string sentence_of(const pipeline::IndirectError& error, const LampCheckParams& params) {
  if (error.places == 0) return "no texel lies outside solids: there is nothing to compare";
  return fmt::format(
      "light of all bounces at {} texels differs from the path tracer's by {:.1f} % (root mean "
      "square over the mean), at 95 % of them by at most {:.1f} %; {} paths each, which err by "
      "{:.1f} %",
      error.places, 100 * error.rms, 100 * error.p95, 2 * params.paths, 100 * error.noise);
}

}  // namespace luxel::view
