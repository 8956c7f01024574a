// Makes one call of the program fail, by plan. The environment says which:
//
//   LUXEL_FAULT=write:3:ENOSPC    the third write() to a file fails with this errno; so do pwrite,
//                                 fsync, rename, link, open (for writing), ftruncate, read, pread
//   LUXEL_FAULT=write:3:SHORT     it does half of what was asked
//   LUXEL_FAULT=new:200           the 200th operator new of main() throws std::bad_alloc
//   LUXEL_FAULT_COUNTS=FILE       at the end, how often each was called: a line "write 12" each
//
// Linked into a copy of the command, whose own definitions come before those of the C library.
// Calls on standard streams, and on files of the kernel (/proc, /sys), count for nothing.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

enum Call {
  kWrite,
  kPwrite,
  kFsync,
  kRename,
  kLink,
  kOpen,
  kFtruncate,
  kRead,
  kPread,
  kNew,
  kCalls
};
constexpr const char* kNames[kCalls] = {"write", "pwrite",    "fsync", "rename", "link",
                                        "open",  "ftruncate", "read",  "pread",  "new"};
constexpr int kShort = -1;

/// The fault that the environment asks for, and counts of calls so far. Plain memory, since it is
/// used before main() begins.
struct Plan {
  int call = kCalls;
  long number = 0;
  int error = 0;
};
std::atomic<long> calls[kCalls];
/// Before main() libraries make tables of their own, and nobody can catch what fails there. The
/// first that main() does is a call of signal().
std::atomic<bool> in_main = false;

int errno_of(const char* name) {
  if (std::strcmp(name, "SHORT") == 0) return kShort;
  if (std::strcmp(name, "EINTR") == 0) return EINTR;
  if (std::strcmp(name, "EIO") == 0) return EIO;
  return ENOSPC;
}

Plan plan_of_environment() {
  Plan plan;
  const char* text = std::getenv("LUXEL_FAULT");
  if (text == nullptr) return plan;
  for (int i = 0; i < kCalls; ++i) {
    const size_t length = std::strlen(kNames[i]);
    if (std::strncmp(text, kNames[i], length) != 0 || text[length] != ':') continue;
    char* end = nullptr;
    plan.number = std::strtol(text + length + 1, &end, 10);
    plan.call = i, plan.error = *end == ':' ? errno_of(end + 1) : 0;
  }
  return plan;
}

const Plan& plan() {
  static const Plan it = plan_of_environment();
  return it;
}

/// Counts a call. True when it is the one that fails.
bool fails(Call call) { return in_main && ++calls[call] == plan().number && plan().call == call; }

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

bool counts(int file) {
  constexpr long kProc = 0x9fa0, kSys = 0x62656572, kCgroup = 0x63677270;
  struct stat about {};
  struct statfs system {};
  return file > STDERR_FILENO && ::fstat(file, &about) == 0 && S_ISREG(about.st_mode) &&
         ::fstatfs(file, &system) == 0 && system.f_type != kProc && system.f_type != kSys &&
         system.f_type != kCgroup;
}

/// -1 with the plan's errno, or half of the bytes by `call`.
template <class Transfer>
ssize_t failed(size_t bytes, const Transfer& call) {
  if (plan().error == kShort) return call(bytes > 1 ? bytes / 2 : bytes);
  errno = plan().error;
  return -1;
}

int failed() {
  errno = plan().error;
  return -1;
}

struct Counts {
  ~Counts() {
    const char* path = std::getenv("LUXEL_FAULT_COUNTS");
    if (path == nullptr) return;
    std::FILE* out = std::fopen(path, "w");
    for (int i = 0; i < kCalls; ++i) std::fprintf(out, "%s %ld\n", kNames[i], calls[i].load());
    std::fclose(out);
  }
} counts_at_the_end;

void* allocated(size_t bytes, size_t alignment) {
  if (fails(kNew)) return nullptr;
  if (bytes == 0) bytes = 1;
  return alignment == 0
             ? std::malloc(bytes)
             : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, size_t count) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
  if (!counts(file) || !fails(kWrite)) return real(file, bytes, count);
  return failed(count, [&](size_t some) { return real(file, bytes, some); });
}
ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
  if (!counts(file) || !fails(kPwrite)) return real(file, bytes, count, at);
  return failed(count, [&](size_t some) { return real(file, bytes, some, at); });
}
ssize_t read(int file, void* bytes, size_t count) {
  static const auto real = next<ssize_t (*)(int, void*, size_t)>("read");
  if (!counts(file) || !fails(kRead)) return real(file, bytes, count);
  return failed(count, [&](size_t some) { return real(file, bytes, some); });
}
ssize_t pread(int file, void* bytes, size_t count, off_t at) {
  static const auto real = next<ssize_t (*)(int, void*, size_t, off_t)>("pread");
  if (!counts(file) || !fails(kPread)) return real(file, bytes, count, at);
  return failed(count, [&](size_t some) { return real(file, bytes, some, at); });
}
int fsync(int file) {
  static const auto real = next<int (*)(int)>("fsync");
  return fails(kFsync) ? failed() : real(file);
}
int rename(const char* from, const char* to) noexcept {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  return fails(kRename) ? failed() : real(from, to);
}
int link(const char* from, const char* to) noexcept {
  static const auto real = next<int (*)(const char*, const char*)>("link");
  return fails(kLink) ? failed() : real(from, to);
}
int ftruncate(int file, off_t length) noexcept {
  static const auto real = next<int (*)(int, off_t)>("ftruncate");
  return fails(kFtruncate) ? failed() : real(file, length);
}
sighandler_t signal(int number, sighandler_t handler) noexcept {
  static const auto real = next<sighandler_t (*)(int, sighandler_t)>("signal");
  in_main = true;
  return real(number, handler);
}
int open(const char* path, int flags, ...) {
  static const auto real = next<int (*)(const char*, int, mode_t)>("open");
  mode_t mode = 0;
  if (flags & (O_CREAT | O_TMPFILE)) {
    va_list rest;
    va_start(rest, flags);
    mode = va_arg(rest, mode_t);
    va_end(rest);
  }
  const bool writes = (flags & O_ACCMODE) != O_RDONLY;
  return writes && fails(kOpen) ? failed() : real(path, flags, mode);
}

}  // extern "C"

namespace {

/// As the C++ library's own: the program's handler is asked for memory, and here has none.
[[noreturn]] void end_of_memory() {
  if (const std::new_handler handler = std::get_new_handler()) handler();
  throw std::bad_alloc();
}

}  // namespace

void* operator new(size_t bytes) {
  if (void* memory = allocated(bytes, 0)) return memory;
  end_of_memory();
}
void* operator new(size_t bytes, std::align_val_t alignment) {
  if (void* memory = allocated(bytes, size_t(alignment))) return memory;
  end_of_memory();
}
void* operator new(size_t bytes, const std::nothrow_t&) noexcept { return allocated(bytes, 0); }
void* operator new[](size_t bytes) { return operator new(bytes); }
void* operator new[](size_t bytes, std::align_val_t alignment) {
  return operator new(bytes, alignment);
}
void* operator new[](size_t bytes, const std::nothrow_t&) noexcept { return allocated(bytes, 0); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
