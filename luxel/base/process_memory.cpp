#include "luxel/base/process_memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace luxel {

namespace {

/// Resident pages of the process, and of those that are files'.
struct ResidentPages {
  uint64_t all = 0, of_files = 0;
};
ResidentPages resident_pages() {
  std::ifstream in("/proc/self/statm");
  uint64_t total = 0;
  ResidentPages out;
  in >> total >> out.all >> out.of_files;
  return out;
}

uint64_t page_bytes() { return uint64_t(::sysconf(_SC_PAGESIZE)); }

}  // namespace

uint64_t resident_bytes() { return resident_pages().all * page_bytes(); }
uint64_t resident_file_bytes() { return resident_pages().of_files * page_bytes(); }

uint64_t peak_resident_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return uint64_t(usage.ru_maxrss) * 1024;
}

void return_free_memory() { ::malloc_trim(0); }

uint64_t available_bytes() {
  std::ifstream in("/proc/meminfo");
  std::string key, unit;
  uint64_t kilobytes = 0;
  while (in >> key >> kilobytes) {
    if (key == "MemAvailable:") return kilobytes * 1024;
    std::getline(in, unit);
  }
  return uint64_t(::sysconf(_SC_PHYS_PAGES)) * uint64_t(::sysconf(_SC_PAGESIZE));
}

}  // namespace luxel
