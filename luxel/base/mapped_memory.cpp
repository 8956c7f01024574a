#include "luxel/base/mapped_memory.h"

#include <sys/mman.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include "luxel/base/process_memory.h"
#include "luxel/base/scratch_file.h"

namespace luxel {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(20);

struct MappedFile {
  ScratchFile file;
  size_t bytes = 0;
};

}  // namespace

struct MappedMemory::State {
  std::filesystem::path folder;
  mutable std::mutex mutex;
  std::map<void*, MappedFile> files;  ///< by where they are mapped
  std::string trouble;
  std::condition_variable over;
  bool is_over = false;
  std::thread watch;

  void let_go() const {
    for (const auto& [place, file] : files) ::madvise(place, file.bytes, MADV_DONTNEED);
  }
  void keep_watch(uint64_t most_resident_bytes) {
    std::unique_lock lock(mutex);
    while (!over.wait_for(lock, kBetweenLooks, [&] { return is_over; }))
      if (resident_bytes() > most_resident_bytes) let_go();
  }
};

MappedMemory::MappedMemory(std::filesystem::path folder, uint64_t most_resident_bytes)
    : state_(std::make_unique<State>()) {
  state_->folder = std::move(folder);
  state_->watch =
      std::thread([s = state_.get(), most_resident_bytes] { s->keep_watch(most_resident_bytes); });
}

MappedMemory::~MappedMemory() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->is_over = true;
  }
  state_->over.notify_all();
  state_->watch.join();
  for (const auto& [place, file] : state_->files) ::munmap(place, file.bytes);
}

void* MappedMemory::allocate(size_t bytes) {
  const std::lock_guard lock(state_->mutex);
  const auto add_file = [&]() -> Result<void*> {
    LUXEL_TRY(ScratchFile file, ScratchFile::create(state_->folder));
    LUXEL_TRY_STATUS(file.reserve(bytes));
    LUXEL_TRY(void* const place, file.map(bytes));
    state_->files.emplace(place, MappedFile{std::move(file), bytes});
    return place;
  };
  const Result<void*> place = add_file();
  if (!place && state_->trouble.empty()) state_->trouble = place.error().message;
  return place.value_or(nullptr);
}

void MappedMemory::release(void* place) {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->files.find(place);
  ::munmap(place, found->second.bytes);
  state_->files.erase(found);
}

bool MappedMemory::holds(const void* place) const {
  const std::lock_guard lock(state_->mutex);
  return state_->files.contains(const_cast<void*>(place));
}

void MappedMemory::let_go() const {
  const std::lock_guard lock(state_->mutex);
  state_->let_go();
}

std::string MappedMemory::trouble() const {
  const std::lock_guard lock(state_->mutex);
  return state_->trouble;
}

}  // namespace luxel
