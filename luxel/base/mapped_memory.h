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

/// Memory that a limit should leave to pages of such files: some threads touch so much between two
/// looks at the memory that the process holds.
inline constexpr uint64_t kMappedPagesBytes = uint64_t(256) << 20;

/// A folder for such files. Arrays that are gone over in order suit them; those of which entries
/// are read here and there do not. All of it is thread-safe. An error of the disk while pages are
/// read or written ends the process, as it does wherever files are mapped; so does a full disk
/// whose file system cannot reserve room.
class MappedMemory {
 public:
  /// Starts a thread that lets go of pages of the files every few milliseconds while the process
  /// holds more than `most_resident_bytes`. What it holds besides is not its affair.
  MappedMemory(std::filesystem::path folder, uint64_t most_resident_bytes);
  ~MappedMemory();
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;

  /// A new file of so many bytes, which are reserved on the disk. Null: it could not be made; see
  /// trouble().
  void* allocate(size_t bytes);
  /// Removes the file of what allocate() gave out. False: it did not give that out.
  bool release(void* place);
  bool holds(const void* place) const;
  /// Lets go of all pages. The files keep what they hold: who looks at them gets them back.
  void let_go() const;
  /// The size of all files that were made.
  uint64_t bytes_made() const;
  /// Errors: those of the first file that could not be made: the disk is full, the folder cannot be
  /// written to.
  Status trouble() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Takes large arrays from a mapped memory, as long as that has room, and all others from the heap.
/// Without one it is std::allocator. A vector that is copied over another stays where that was.
template <class T>
struct MappedAllocator {
  using value_type = T;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;
  using is_always_equal = std::false_type;

  std::shared_ptr<MappedMemory> memory;

  MappedAllocator() = default;
  MappedAllocator(std::shared_ptr<MappedMemory> m) : memory(std::move(m)) {}
  template <class U>
  MappedAllocator(const MappedAllocator<U>& other) : memory(other.memory) {}

  T* allocate(size_t count) {
    if (memory && is_large(count) && count <= SIZE_MAX / sizeof(T))
      if (void* place = memory->allocate(count * sizeof(T))) return static_cast<T*>(place);
    return std::allocator<T>().allocate(count);
  }
  void deallocate(T* place, size_t count) {
    if (!memory || !is_large(count) || !memory->release(place))
      std::allocator<T>().deallocate(place, count);
  }
  friend bool operator==(const MappedAllocator& a, const MappedAllocator& b) {
    return a.memory == b.memory;
  }

 private:
  static bool is_large(size_t count) { return count > (size_t(1) << 20) / sizeof(T); }
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
