#include "luxel/base/mapped_memory.h"

#include <sys/mman.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "luxel/base/process_memory.h"
#include "luxel/base/scratch_file.h"

namespace luxel {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(20);
/// With fewer pages of files than this, letting go of them helps nobody.
constexpr uint64_t kWorthLettingGo = uint64_t(64) << 20;

}  // namespace

struct MappedMemory::State {
  struct MappedFile {
    ScratchFile file;
    size_t bytes = 0;
    void* place = nullptr;
  };

  std::filesystem::path folder;
  mutable std::mutex mutex;
  std::map<const void*, MappedFile> files;  ///< by where they are mapped
  uint64_t bytes_made = 0;
  std::optional<Error> trouble;
  std::condition_variable over;
  bool is_over = false;
  std::thread watch;

  Result<MappedFile> make_file(size_t file_bytes) const {
    LUXEL_TRY(ScratchFile file, ScratchFile::create(folder));
    LUXEL_TRY_STATUS(file.reserve(file_bytes));
    LUXEL_TRY(void* const place, file.map(file_bytes));
    return MappedFile{std::move(file), file_bytes, place};
  }
  void let_go() const {
    for (const auto& [place, file] : files) ::madvise(file.place, file.bytes, MADV_DONTNEED);
  }
  void keep_watch(uint64_t most_resident_bytes) {
    std::unique_lock lock(mutex);
    while (!over.wait_for(lock, kBetweenLooks, [&] { return is_over; }))
      if (resident_bytes() > most_resident_bytes && resident_file_bytes() > kWorthLettingGo)
        let_go();
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
  for (const auto& [place, file] : state_->files) ::munmap(file.place, file.bytes);
}

void* MappedMemory::allocate(size_t bytes) {
  // Where the file system cannot reserve room it writes all of it: the watch goes on meanwhile.
  Result<State::MappedFile> made = state_->make_file(bytes);
  const std::lock_guard lock(state_->mutex);
  if (!made) {
    if (!state_->trouble) state_->trouble = made.error();
    return nullptr;
  }
  void* const place = made->place;
  state_->bytes_made += bytes;
  state_->files.emplace(place, std::move(*made));
  return place;
}

bool MappedMemory::release(void* place) {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->files.find(place);
  if (found == state_->files.end()) return false;
  ::munmap(place, found->second.bytes);
  state_->files.erase(found);
  return true;
}

bool MappedMemory::holds(const void* place) const {
  const std::lock_guard lock(state_->mutex);
  return state_->files.contains(place);
}

void MappedMemory::let_go() const {
  const std::lock_guard lock(state_->mutex);
  state_->let_go();
}

uint64_t MappedMemory::bytes_made() const {
  const std::lock_guard lock(state_->mutex);
  return state_->bytes_made;
}

Status MappedMemory::trouble() const {
  const std::lock_guard lock(state_->mutex);
  if (state_->trouble) return Failure{*state_->trouble};
  return {};
}

}  // namespace luxel
