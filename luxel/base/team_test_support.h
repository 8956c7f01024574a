// A team whose members are threads of one process, for tests.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "luxel/base/team.h"

namespace luxel {
inline namespace base {

/// The state that members share.
struct ThreadTeamState {
  explicit ThreadTeamState(uint32_t members) : size(members), sent(members) {}

  const uint32_t size;
  std::mutex mutex;
  std::condition_variable changed;
  uint64_t counter = 0, gathers = 0, bytes = 0;
  uint32_t waiting = 0;
  std::vector<std::vector<std::byte>> sent, received;
  std::optional<Error> given_up;
  Team::Done told;
};

class ThreadTeam final : public Team {
 public:
  ThreadTeam(std::shared_ptr<ThreadTeamState> state, uint32_t rank)
      : state_(std::move(state)), rank_(rank) {}

  uint32_t rank() const override { return rank_; }
  uint32_t size() const override { return state_->size; }

  Status begin_stage(Progress& progress) override {
    if (rank_ == 0) {
      const std::lock_guard lock(state_->mutex);
      state_->counter = 0, state_->told = {};
    }
    return all_gather({}, progress).map([](const auto&) {});
  }
  uint64_t next(uint64_t count) override {
    const std::lock_guard lock(state_->mutex);
    if (state_->given_up) return UINT64_MAX / 2;
    return std::exchange(state_->counter, state_->counter + count);
  }
  Result<std::vector<std::vector<std::byte>>> all_gather(std::span<const std::byte> own,
                                                         Progress& progress) override {
    std::unique_lock lock(state_->mutex);
    if (state_->given_up) return Failure{*state_->given_up};
    state_->sent[rank_].assign(own.begin(), own.end());
    state_->bytes += own.size();
    const uint64_t number = state_->gathers;
    if (++state_->waiting == state_->size) {
      state_->received = std::move(state_->sent);
      state_->sent.assign(state_->size, {});
      state_->waiting = 0, ++state_->gathers;
      state_->changed.notify_all();
    }
    while (state_->gathers == number) {
      if (state_->given_up) return Failure{*state_->given_up};
      if (progress.cancelled()) return fail(ErrorCode::cancelled, "cancelled");
      state_->changed.wait_for(lock, std::chrono::milliseconds(20));
    }
    return state_->received;
  }
  Gathered gathered() const override {
    const std::lock_guard lock(state_->mutex);
    return {state_->gathers, state_->bytes};
  }
  void tell(Done done) override {
    const std::lock_guard lock(state_->mutex);
    state_->told.units += done.units, state_->told.skipped += done.skipped;
  }
  Done told() override {
    const std::lock_guard lock(state_->mutex);
    return std::exchange(state_->told, {});
  }
  void give_up(const Error& error) override {
    const std::lock_guard lock(state_->mutex);
    if (!state_->given_up)
      state_->given_up = Error{error.code, fmt::format("process {}: {}", rank_, error.message)};
    state_->changed.notify_all();
  }

 private:
  std::shared_ptr<ThreadTeamState> state_;
  const uint32_t rank_;
};

/// Calls work(team) for each member in a thread of its own, and waits for all. Returns the bytes
/// that they have sent.
template <class Work>
uint64_t as_team(uint32_t members, const Work& work) {
  const auto state = std::make_shared<ThreadTeamState>(members);
  std::vector<std::thread> threads;
  for (uint32_t rank = 0; rank < members; ++rank)
    threads.emplace_back([&, rank] {
      ThreadTeam team(state, rank);
      work(team);
    });
  for (std::thread& thread : threads) thread.join();
  return state->bytes;
}

}  // namespace base
}  // namespace luxel
