// A library to preload: lets the n-th system call on files below a folder fail, as on a full or
// damaged disk, or sends its process a signal just before. Nothing happens until
// `failing_calls_arm` is called; a forked process inherits what is armed.

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#define EXPORT extern "C" __attribute__((visibility("default")))

namespace {

char g_folder[PATH_MAX] = "";
std::size_t g_folder_length = 0;
int g_error = 0;
int g_signal = 0;           // sent instead of failing
bool g_is_lasting = false;  // whether all later calls that the error fits fail, too
bool g_is_short = false;    // whether a failing write first takes half of its bytes
std::atomic<long> g_left{0};
std::atomic<long> g_failed{0};
std::atomic<bool> g_is_armed{false};
char g_call[32] = "";

enum class Kind { kOpen, kCreate, kWrite, kFlush, kClose, kName, kRemove, kLock, kAttribute };

/// Whether the system may give this error for such a call.
bool fits(Kind kind) {
  if (g_signal != 0) return true;
  switch (g_error) {
    case ENOSPC:
    case EDQUOT:
      return kind == Kind::kCreate || kind == Kind::kWrite || kind == Kind::kFlush ||
             kind == Kind::kClose || kind == Kind::kName;
    case EROFS:
      return kind == Kind::kCreate || kind == Kind::kName || kind == Kind::kRemove ||
             kind == Kind::kAttribute;
    case EACCES:
      return kind == Kind::kOpen || kind == Kind::kCreate || kind == Kind::kName ||
             kind == Kind::kRemove;
    case ENOLCK:
      return kind == Kind::kLock;
    default:
      return kind != Kind::kLock;
  }
}

bool is_below(const char* path) {
  return strncmp(path, g_folder, g_folder_length) == 0 &&
         (path[g_folder_length] == '/' || path[g_folder_length] == '\0');
}

bool find_path(int descriptor, char* path) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = ::readlink(link, path, PATH_MAX - 1);
  if (length < 0) return false;
  path[length] = '\0';
  return true;
}

/// Whether this call is the one to fail.
bool is_due(const char* call, Kind kind) {
  if (!fits(kind)) return false;
  const long left = g_left.fetch_sub(1);
  if (left > 1 || (left < 1 && !g_is_lasting)) return false;
  if (g_failed.fetch_add(1) == 0) snprintf(g_call, sizeof g_call, "%s", call);
  if (g_signal == 0) return true;
  ::raise(g_signal);
  return false;
}

bool fails(const char* call, Kind kind, int descriptor) {
  if (!g_is_armed) return false;
  const int before = errno;
  char path[PATH_MAX];
  const bool due = find_path(descriptor, path) && is_below(path) && is_due(call, kind);
  errno = due ? g_error : before;
  return due;
}

bool fails_at(const char* call, Kind kind, int folder, const char* name) {
  if (!g_is_armed || name == nullptr) return false;
  const int before = errno;
  char path[2 * PATH_MAX] = "";
  bool known = true;
  if (name[0] != '/') {
    known = folder == AT_FDCWD ? ::getcwd(path, PATH_MAX) != nullptr : find_path(folder, path);
    strcat(path, "/");
  }
  strncat(path, name, PATH_MAX - 1);
  const bool due = known && is_below(path) && is_due(call, kind);
  errno = due ? g_error : before;
  return due;
}

template <class Function>
Function* find_next(Function* /*own*/, const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

Kind kind_of(int flags) {
  return (flags & (O_WRONLY | O_RDWR | O_CREAT | O_TRUNC)) != 0 ? Kind::kCreate : Kind::kOpen;
}

/// How many bytes a failing write may take before: half of them, once.
std::size_t take_half(std::size_t size) {
  const bool takes = g_is_short && g_failed == 1 && size > 1;
  return takes ? size / 2 : 0;
}

/// Whether closing a descriptor may tell of bytes that were not written.
bool is_written_to(int file) {
  const int flags = g_is_armed ? ::fcntl(file, F_GETFL) : -1;
  return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}

}  // namespace

/// The `number`-th call from now on, counted from 1, fails with `error`, or meets `signal` if not
/// 0.
EXPORT void failing_calls_arm(const char* folder, long number, int error, int signal,
                              int is_lasting, int is_short) {
  g_is_armed = false;
  snprintf(g_folder, sizeof g_folder, "%s", folder);
  g_folder_length = strlen(g_folder);
  g_error = error;
  g_signal = signal;
  g_is_lasting = is_lasting != 0;
  g_is_short = is_short != 0;
  g_left = number;
  g_failed = 0;
  g_call[0] = '\0';
  g_is_armed = true;
}

EXPORT void failing_calls_disarm() { g_is_armed = false; }

/// How many calls have failed.
EXPORT long failing_calls_failed() { return g_failed; }

/// The name of the first call that failed.
EXPORT const char* failing_calls_first() { return g_call; }

#define NEXT(name) static const auto next = find_next(&::name, #name)

#define OPEN(name)                                                   \
  EXPORT int name(const char* path, int flags, ...) {                \
    NEXT(name);                                                      \
    va_list arguments;                                               \
    va_start(arguments, flags);                                      \
    const mode_t mode = va_arg(arguments, mode_t);                   \
    va_end(arguments);                                               \
    if (fails_at("open", kind_of(flags), AT_FDCWD, path)) return -1; \
    return next(path, flags, mode);                                  \
  }
#define OPEN_AT(name)                                                \
  EXPORT int name(int folder, const char* path, int flags, ...) {    \
    NEXT(name);                                                      \
    va_list arguments;                                               \
    va_start(arguments, flags);                                      \
    const mode_t mode = va_arg(arguments, mode_t);                   \
    va_end(arguments);                                               \
    if (fails_at("openat", kind_of(flags), folder, path)) return -1; \
    return next(folder, path, flags, mode);                          \
  }
#define PLACED_WRITE(name, offset_type)                                           \
  EXPORT ssize_t name(int file, const void* bytes, size_t size, offset_type at) { \
    NEXT(name);                                                                   \
    if (!fails("pwrite", Kind::kWrite, file)) return next(file, bytes, size, at); \
    const size_t half = take_half(size);                                          \
    return half > 0 ? next(file, bytes, half, at) : -1;                           \
  }
#define TRUNCATE(name, offset_type)                        \
  EXPORT int name(int file, offset_type size) noexcept {   \
    NEXT(name);                                            \
    if (fails("ftruncate", Kind::kWrite, file)) return -1; \
    return next(file, size);                               \
  }
#define SEND(name, offset_type)                                                  \
  EXPORT ssize_t name(int to, int from, offset_type* at, size_t size) noexcept { \
    NEXT(name);                                                                  \
    if (fails("sendfile", Kind::kWrite, to)) return -1;                          \
    return next(to, from, at, size);                                             \
  }

OPEN(open)
OPEN(open64)
OPEN_AT(openat)
OPEN_AT(openat64)
PLACED_WRITE(pwrite, off_t)
PLACED_WRITE(pwrite64, off64_t)
TRUNCATE(ftruncate, off_t)
TRUNCATE(ftruncate64, off64_t)
SEND(sendfile, off_t)
SEND(sendfile64, off64_t)

EXPORT ssize_t write(int file, const void* bytes, size_t size) {
  NEXT(write);
  if (!fails("write", Kind::kWrite, file)) return next(file, bytes, size);
  const size_t half = take_half(size);
  return half > 0 ? next(file, bytes, half) : -1;
}

EXPORT ssize_t writev(int file, const iovec* parts, int count) {
  NEXT(writev);
  return fails("writev", Kind::kWrite, file) ? -1 : next(file, parts, count);
}

EXPORT ssize_t copy_file_range(int from, off64_t* from_at, int to, off64_t* to_at, size_t size,
                               unsigned flags) {
  NEXT(copy_file_range);
  if (fails("copy_file_range", Kind::kWrite, to)) return -1;
  return next(from, from_at, to, to_at, size, flags);
}

EXPORT int posix_fallocate(int file, off_t offset, off_t size) {
  NEXT(posix_fallocate);
  return fails("posix_fallocate", Kind::kWrite, file) ? g_error : next(file, offset, size);
}

EXPORT int fsync(int file) {
  NEXT(fsync);
  return fails("fsync", Kind::kFlush, file) ? -1 : next(file);
}

EXPORT int fdatasync(int file) {
  NEXT(fdatasync);
  return fails("fdatasync", Kind::kFlush, file) ? -1 : next(file);
}

/// As Linux does, closes the descriptor even so.
EXPORT int close(int file) {
  NEXT(close);
  const bool due = is_written_to(file) && fails("close", Kind::kClose, file);
  const int result = next(file);
  if (due) errno = g_error;
  return due ? -1 : result;
}

EXPORT int rename(const char* from, const char* to) noexcept {
  NEXT(rename);
  return fails_at("rename", Kind::kName, AT_FDCWD, to) ? -1 : next(from, to);
}

EXPORT int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  NEXT(renameat);
  if (fails_at("renameat", Kind::kName, to_folder, to)) return -1;
  return next(from_folder, from, to_folder, to);
}

EXPORT int link(const char* from, const char* to) noexcept {
  NEXT(link);
  return fails_at("link", Kind::kName, AT_FDCWD, to) ? -1 : next(from, to);
}

EXPORT int linkat(int from_folder, const char* from, int to_folder, const char* to,
                  int flags) noexcept {
  NEXT(linkat);
  if (fails_at("linkat", Kind::kName, to_folder, to)) return -1;
  return next(from_folder, from, to_folder, to, flags);
}

EXPORT int mkdir(const char* path, mode_t mode) noexcept {
  NEXT(mkdir);
  return fails_at("mkdir", Kind::kCreate, AT_FDCWD, path) ? -1 : next(path, mode);
}

EXPORT int mkdirat(int folder, const char* path, mode_t mode) noexcept {
  NEXT(mkdirat);
  return fails_at("mkdirat", Kind::kCreate, folder, path) ? -1 : next(folder, path, mode);
}

EXPORT int unlink(const char* path) noexcept {
  NEXT(unlink);
  return fails_at("unlink", Kind::kRemove, AT_FDCWD, path) ? -1 : next(path);
}

EXPORT int unlinkat(int folder, const char* path, int flags) noexcept {
  NEXT(unlinkat);
  return fails_at("unlinkat", Kind::kRemove, folder, path) ? -1 : next(folder, path, flags);
}

EXPORT int rmdir(const char* path) noexcept {
  NEXT(rmdir);
  return fails_at("rmdir", Kind::kRemove, AT_FDCWD, path) ? -1 : next(path);
}

EXPORT int chmod(const char* path, mode_t mode) noexcept {
  NEXT(chmod);
  return fails_at("chmod", Kind::kAttribute, AT_FDCWD, path) ? -1 : next(path, mode);
}

EXPORT int utimensat(int folder, const char* path, const timespec times[2], int flags) noexcept {
  NEXT(utimensat);
  if (fails_at("utimensat", Kind::kAttribute, folder, path)) return -1;
  return next(folder, path, times, flags);
}

EXPORT int flock(int file, int operation) noexcept {
  NEXT(flock);
  return fails("flock", Kind::kLock, file) ? -1 : next(file, operation);
}
