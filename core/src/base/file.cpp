#include "base/file.h"

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "base/text.h"

namespace voxshell {
namespace {

constexpr int kClosed = -1;
constexpr int kMostLinks = 40;  // as Linux follows
constexpr std::time_t kStaleSeconds = 600;

Error access_error(const char* what, const std::string& path, const std::string& why) {
  return {ErrorCode::kFileAccess, format_text("cannot %s %s: %s", what, path.c_str(), why.c_str())};
}

Error last_error(const char* what, const std::string& path) {
  return access_error(what, path, std::generic_category().message(errno));
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

Result<std::monostate> check_name(const char* what, const std::string& path) {
  if (path.find('\0') == std::string::npos) return std::monostate{};
  return access_error(what, path, "its name holds a null character");
}

const char* describe_irregular(mode_t mode) {
  return S_ISDIR(mode) ? "it is a folder" : "it is not a regular file";
}

/// The file that is written where `path` is: where links lead, whether or not there is one yet.
Result<std::string> find_target(const std::string& path) {
  std::string target = path;
  for (int links = 0; links <= kMostLinks; ++links) {
    struct stat status{};
    if (::lstat(target.c_str(), &status) != 0) {
      if (errno == ENOENT) return target;
      return last_error("write", path);
    }
    if (S_ISREG(status.st_mode)) return target;
    if (!S_ISLNK(status.st_mode)) {
      return access_error("write", path, describe_irregular(status.st_mode));
    }
    std::error_code error;
    const std::string link = std::filesystem::read_symlink(target, error).string();
    if (error) return access_error("write", path, error.message());
    const std::size_t kept = link.starts_with('/') ? 0 : target.rfind('/') + 1;
    target.replace(kept, std::string::npos, link);
  }
  return access_error("write", path, std::generic_category().message(ELOOP));
}

/// Calls again where a signal came in between.
template <class Call>
auto retry(const Call& call) {
  while (true) {
    const auto result = call();
    if (result >= 0 || errno != EINTR) return result;
  }
}

/// The beginning of the names of this machine's unfinished files, whose locks it knows.
std::string unfinished_name() {
  char host[256] = "";
  ::gethostname(host, sizeof(host) - 1);
  std::uint32_t hash = 2166136261u;  // FNV-1a
  for (const char* letter = host; *letter != '\0'; ++letter) {
    hash = (hash ^ static_cast<unsigned char>(*letter)) * 16777619u;
  }
  return OutputFile::kUnfinishedPrefix + std::to_string(hash) + "-";
}

/// The beginning of the names of files that could not be locked. No machine knows their locks, so
/// that they are removed by their age alone, also if locks work a moment later.
std::string unlockable_name() { return std::string(OutputFile::kUnfinishedPrefix) + "0-"; }

enum class Lock { kHeld, kTaken, kUnknown };

/// Locks an open file until it is closed, be it by the end of a killed process.
Lock try_lock(int descriptor) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return Lock::kHeld;
  return errno == EWOULDBLOCK ? Lock::kTaken : Lock::kUnknown;
}

bool is_at(int descriptor, const std::string& path) {
  struct stat open{};
  struct stat named{};
  return ::fstat(descriptor, &open) == 0 && ::lstat(path.c_str(), &named) == 0 &&
         open.st_dev == named.st_dev && open.st_ino == named.st_ino;
}

/// Removes an unfinished file unless its writer may be alive. A writer holds a lock. Those of other
/// machines may be unknown here, and some disks know none; but no writer leaves its file alone for
/// so long, by the clock of the disk.
void remove_stale_file(const std::string& path, bool is_ours, std::time_t now) {
  const int descriptor =
      retry([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK); });
  if (descriptor < 0) return;
  const Lock lock = try_lock(descriptor);
  struct stat status{};
  if (lock != Lock::kTaken && ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
      ((is_ours && lock == Lock::kHeld) || status.st_mtime < now - kStaleSeconds)) {
    ::unlink(path.c_str());
  }
  ::close(descriptor);
}

void remove_stale_files(const std::string& folder, std::time_t now) {
  const std::string prefix = OutputFile::kUnfinishedPrefix;
  const std::string suffix = OutputFile::kUnfinishedSuffix;
  const std::string ours = unfinished_name();
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(suffix) &&
        name.find_first_not_of("0123456789-", prefix.size()) == name.size() - suffix.size()) {
      remove_stale_file(entry->path().string(), name.starts_with(ours), now);
    }
  }
}

}  // namespace

Result<InputFile> InputFile::open(const std::string& path) {
  if (auto checked = check_name("read", path); !checked) return checked.error();
  // Without waiting for a writer, should it be a pipe.
  const int descriptor =
      retry([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK); });
  if (descriptor < 0) return last_error("read", path);
  struct stat status{};
  if (::fstat(descriptor, &status) != 0) {
    const Error error = last_error("read", path);
    ::close(descriptor);
    return error;
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return access_error("read", path, describe_irregular(status.st_mode));
  }
  return InputFile(descriptor, static_cast<std::uint64_t>(status.st_size));
}

InputFile::InputFile(InputFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, kClosed)), size_(other.size_) {}

InputFile::~InputFile() {
  if (descriptor_ != kClosed) ::close(descriptor_);
}

Result<std::monostate> InputFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto count = retry([&] {
      return ::pread(descriptor_, bytes.data() + done, bytes.size() - done,
                     static_cast<off_t>(offset + done));
    });
    if (count < 0) {
      return Error{ErrorCode::kFileAccess,
                   format_text("cannot read the file at byte %llu: %s",
                               static_cast<unsigned long long>(offset),
                               std::generic_category().message(errno).c_str())};
    }
    if (count == 0) {
      return Error{ErrorCode::kFileAccess,
                   format_text("the file became shorter than %llu bytes while it was read",
                               static_cast<unsigned long long>(size_))};
    }
    done += static_cast<std::size_t>(count);
  }
  return std::monostate{};
}

Result<OutputFile> OutputFile::create(const std::string& path) {
  if (auto checked = check_name("write", path); !checked) return checked.error();
  auto target = find_target(path);
  if (!target) return target.error();
  const std::string folder = folder_of(*target);
  // The name of this process and a number tell all writers apart; what a dead process of the same
  // number left behind is stepped over.
  static std::atomic<unsigned> counter{0};
  constexpr int kMostTrials = 10'000;
  std::string beginning = unfinished_name();
  for (int trial = 0; trial < kMostTrials; ++trial) {
    std::string unfinished =
        format_text("%s/%s%d-%u%s", folder.c_str(), beginning.c_str(), static_cast<int>(::getpid()),
                    counter.fetch_add(1), kUnfinishedSuffix);
    const int descriptor = retry(
        [&] { return ::open(unfinished.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); });
    if (descriptor >= 0) {
      // Whoever sweeps may have found it before it was locked.
      const Lock lock = try_lock(descriptor);
      const bool needs_other_name = lock == Lock::kUnknown && beginning != unlockable_name();
      if (lock == Lock::kTaken || needs_other_name || !is_at(descriptor, unfinished)) {
        ::close(descriptor);
        ::unlink(unfinished.c_str());
        if (needs_other_name) beginning = unlockable_name();
        continue;
      }
      struct stat status{};
      if (::fstat(descriptor, &status) == 0) remove_stale_files(folder, status.st_mtime);
      return OutputFile(descriptor, std::move(unfinished), *std::move(target));
    }
    if (errno != EEXIST) break;
  }
  return last_error("write", path);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, kClosed)),
      unfinished_path_(std::move(other.unfinished_path_)),
      path_(std::move(other.path_)) {}

OutputFile::~OutputFile() { close_and_remove(); }

void OutputFile::close_and_remove() {
  if (descriptor_ == kClosed) return;
  ::close(std::exchange(descriptor_, kClosed));
  ::unlink(unfinished_path_.c_str());
}

Result<std::monostate> OutputFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto count = retry([&] { return ::write(descriptor_, bytes.data(), bytes.size()); });
    if (count < 0) return last_error("write", path_);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return std::monostate{};
}

Result<std::monostate> OutputFile::commit() {
  if (::fsync(descriptor_) != 0 || ::rename(unfinished_path_.c_str(), path_.c_str()) != 0) {
    const Error error = last_error("write", path_);
    close_and_remove();
    return error;
  }
  ::close(std::exchange(descriptor_, kClosed));
  // The new name itself must survive a power cut; where a folder cannot be flushed, the file is
  // still whole.
  const int folder =
      retry([&] { return ::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return std::monostate{};
}

}  // namespace voxshell
