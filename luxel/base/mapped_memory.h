// Arrays that need not stay in memory: each lies in a temporary file without a name, which is
// mapped to addresses. The system reads pages when they are looked at, and writes back what has
// changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "luxel/base/result.h"

namespace luxel {

/// What pages of such files may take in any case. Two threads look at so many between one look at
/// the memory that is held and the next.
inline constexpr uint64_t kMappedPagesBytes = uint64_t(256) << 20;

/// A folder for such files. Arrays that are gone over in order suit them; those of which entries
/// are read here and there do not.
class MappedMemory {
 public:
  /// While the process holds more than `most_resident_bytes`, a thread lets go of pages of the
  /// files every few milliseconds.
  MappedMemory(std::filesystem::path folder, uint64_t most_resident_bytes);
  ~MappedMemory();
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;

  /// A new file of so many bytes, all of which the disk then has. Thread-safe, as all of these.
  /// Null: the folder has no room; see trouble().
  void* allocate(size_t bytes);
  /// Removes the file of what allocate() gave out.
  void release(void* place);
  bool holds(const void* place) const;
  /// Lets go of all pages. The files keep what they hold: who looks at them gets them back.
  void let_go() const;
  /// Why a file could not be made; empty: all could.
  std::string trouble() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Takes large arrays from a mapped memory, as long as that has room, and all others from the heap.
/// Without one it is std::allocator.
template <class T>
struct MappedAllocator {
  using value_type = T;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;
  using is_always_equal = std::false_type;
  static constexpr size_t kSmallBytes = 1 << 20;

  std::shared_ptr<MappedMemory> memory;

  MappedAllocator() = default;
  MappedAllocator(std::shared_ptr<MappedMemory> m) : memory(std::move(m)) {}
  template <class U>
  MappedAllocator(const MappedAllocator<U>& other) : memory(other.memory) {}

  T* allocate(size_t count) {
    if (memory && count > kSmallBytes / sizeof(T) && count <= SIZE_MAX / sizeof(T))
      if (void* place = memory->allocate(count * sizeof(T))) return static_cast<T*>(place);
    return std::allocator<T>().allocate(count);
  }
  void deallocate(T* place, size_t count) {
    if (memory && memory->holds(place))
      memory->release(place);
    else
      std::allocator<T>().deallocate(place, count);
  }
  friend bool operator==(const MappedAllocator& a, const MappedAllocator& b) {
    return a.memory == b.memory;
  }
};

/// A vector that may lie in a mapped memory.
template <class T>
using MappedVector = std::vector<T, MappedAllocator<T>>;

/// A copy of it on the heap.
template <class T>
std::vector<T> copied(const MappedVector<T>& entries) {
  return {entries.begin(), entries.end()};
}

}  // namespace luxel
