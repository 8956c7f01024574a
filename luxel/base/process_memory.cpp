#include "luxel/base/process_memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>

namespace luxel {

namespace {

/// Pages of the process: with addresses, resident, and of the latter those that are files'.
struct Pages {
  uint64_t total = 0, resident = 0, of_files = 0;
};
Pages pages() {
  std::ifstream in("/proc/self/statm");
  Pages out;
  in >> out.total >> out.resident >> out.of_files;
  return out;
}

uint64_t page_bytes() { return uint64_t(::sysconf(_SC_PAGESIZE)); }

/// The line `key` of a file of lines "key number kB"; 0: there is none.
uint64_t stated_bytes(const char* file, const std::string& key) {
  std::ifstream in(file);
  std::string word, rest;
  while (in >> word) {
    uint64_t kilobytes = 0;
    if (word == key && in >> kilobytes) return kilobytes * 1024;
    std::getline(in, rest);
  }
  return 0;
}

}  // namespace

uint64_t resident_bytes() { return pages().resident * page_bytes(); }
uint64_t resident_file_bytes() { return pages().of_files * page_bytes(); }
uint64_t virtual_bytes() { return pages().total * page_bytes(); }

uint64_t peak_resident_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return uint64_t(usage.ru_maxrss) * 1024;
}

void return_free_memory() { ::malloc_trim(0); }

uint64_t available_bytes() {
  const uint64_t available = stated_bytes("/proc/meminfo", "MemAvailable:");
  return available > 0 ? available : uint64_t(::sysconf(_SC_PHYS_PAGES)) * page_bytes();
}

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHasOwnMemory = false;
#else
constexpr bool kHasOwnMemory = true;
#endif

/// Taken while a MemoryLimit counts.
std::atomic_flag& limit_is_taken() {
  static constinit std::atomic_flag taken;
  return taken;
}

}  // namespace

MemoryLimit::MemoryLimit(uint64_t more_bytes) {
  if (!kHasOwnMemory || limit_is_taken().test_and_set()) return;
  rlimit limit{};
  // RLIMIT_DATA counts private memory that may be written to, used or not.
  const uint64_t held = stated_bytes("/proc/self/status", "VmData:");
  if (held > 0 && ::getrlimit(RLIMIT_DATA, &limit) == 0) {
    before_ = limit.rlim_cur;
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, held + more_bytes);
    is_set_ = ::setrlimit(RLIMIT_DATA, &limit) == 0;
  }
  if (!is_set_) limit_is_taken().clear();
}

MemoryLimit::~MemoryLimit() {
  if (!is_set_) return;
  rlimit limit{};
  if (::getrlimit(RLIMIT_DATA, &limit) == 0) {
    limit.rlim_cur = before_;
    ::setrlimit(RLIMIT_DATA, &limit);
  }
  limit_is_taken().clear();
}

}  // namespace luxel
