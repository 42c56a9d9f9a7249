#include "base/file.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace voxshell::file_test {
namespace {

using test_support::TemporaryFolder;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

class File : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string content(const std::string& name) const {
    std::ifstream file(folder_.path() / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::ptrdiff_t file_count() const {
    return std::distance(std::filesystem::directory_iterator(folder_.path()), {});
  }

  TemporaryFolder folder_;
};

TEST_F(File, AppearsWhenItIsCommitted) {
  auto file = OutputFile::create(path("a"));
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_TRUE(file->append(bytes_of("hello ")));
  ASSERT_TRUE(file->append(bytes_of("world")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a"));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(content("a"), "hello world");
  EXPECT_EQ(file_count(), 1);
  struct stat status{};
  ASSERT_EQ(::stat(path("a").c_str(), &status), 0);
  EXPECT_NE(status.st_mode & S_IRUSR, 0u);
}

TEST_F(File, LeavesNothingWhereItIsNotCommitted) {
  std::ofstream(path("a")) << "before";
  {
    auto file = OutputFile::create(path("a"));
    ASSERT_TRUE(file);
    auto moved = *std::move(file);
    ASSERT_TRUE(moved.append(bytes_of("after")));
    EXPECT_EQ(file_count(), 2);
  }
  EXPECT_EQ(content("a"), "before");
  EXPECT_EQ(file_count(), 1);
}

TEST_F(File, OfManyWritersIsOneOfTheirs) {
  auto first = OutputFile::create(path("a"));
  auto second = OutputFile::create(path("a"));
  ASSERT_TRUE(first && second);
  ASSERT_TRUE(first->append(bytes_of("first")));
  ASSERT_TRUE(second->append(bytes_of("second")));
  ASSERT_TRUE(second->commit());
  EXPECT_EQ(content("a"), "second");
  ASSERT_TRUE(first->commit());
  EXPECT_EQ(content("a"), "first");
}

TEST_F(File, ThatTheDiskHasNoRoomForIsAnErrorAndLeavesTheOneBefore) {
  std::ofstream(path("a")) << "before";
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{4096, limit.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  {
    auto file = OutputFile::create(path("a"));
    ASSERT_TRUE(file);
    const auto written = file->append(bytes_of(std::string(10'000, 'x')));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::kFileAccess);
    EXPECT_NE(written.error().message.find("File too large"), std::string::npos)
        << written.error().message;
  }
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(content("a"), "before");
  EXPECT_EQ(file_count(), 1);
}

void expect_unwritable(const std::string& path, const std::string& reason) {
  auto file = OutputFile::create(path);
  const auto failed = file ? file->commit() : Result<std::monostate>(file.error());
  ASSERT_FALSE(failed) << path;
  EXPECT_EQ(failed.error().code, ErrorCode::kFileAccess);
  EXPECT_NE(failed.error().message.find(reason), std::string::npos) << failed.error().message;
}

TEST_F(File, CannotBeWrittenWhereThereIsNoFolderOrIsOne) {
  expect_unwritable(path("missing/a"), "No such file or directory");
  std::filesystem::create_directory(folder_.path() / "folder");
  expect_unwritable(path("folder"), "it is a folder");
  std::ofstream(path("text")) << "x";
  expect_unwritable(path("text/a"), "Not a directory");
  expect_unwritable(std::string("a\0b", 3), "null character");
  EXPECT_EQ(file_count(), 2);
}

TEST_F(File, DoesNotTakeThePlaceOfWhatIsNoRegularFile) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("pipe", folder_.path() / "link");
  for (const char* name : {"pipe", "link"}) {
    const auto file = OutputFile::create(path(name));
    ASSERT_FALSE(file) << name;
    EXPECT_EQ(file.error().code, ErrorCode::kFileAccess);
    EXPECT_EQ(file.error().message, "cannot write " + path(name) + ": it is not a regular file");
  }
  EXPECT_TRUE(std::filesystem::is_fifo(folder_.path() / "pipe"));
  EXPECT_EQ(file_count(), 2);
}

TEST_F(File, IsWrittenWhereLinksLead) {
  std::filesystem::create_directory(folder_.path() / "folder");
  std::ofstream(path("folder/a")) << "before";
  std::filesystem::create_symlink("folder/a", folder_.path() / "link");
  std::filesystem::create_symlink(path("link"), folder_.path() / "far");
  std::filesystem::create_symlink("folder/new", folder_.path() / "dangling");
  for (const char* name : {"far", "dangling"}) {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file_count(), 4) << "not beside the link";
    ASSERT_TRUE(file->append(bytes_of("after")));
    ASSERT_TRUE(file->commit());
    EXPECT_TRUE(std::filesystem::is_symlink(folder_.path() / name));
  }
  EXPECT_EQ(content("folder/a"), "after");
  EXPECT_EQ(content("folder/new"), "after");
  std::filesystem::create_symlink("round", folder_.path() / "round");
  expect_unwritable(path("round"), "Too many levels of symbolic links");
}

TEST_F(File, SweepsWhatKilledWritersLeft) {
  const auto leave = [&](const std::string& name, int minutes) {
    std::ofstream(path(name)) << "torn";
    std::filesystem::last_write_time(
        path(name), std::filesystem::file_time_type::clock::now() - std::chrono::minutes(minutes));
  };
  leave(".voxshell-1-2.tmp", 11);
  leave(".voxshell-1-3.tmp", 9);
  leave(".voxshell-notes.tmp", 11);
  leave(".voxshell-1-2.tmp.vxs", 11);
  auto file = OutputFile::create(path("a"));
  ASSERT_TRUE(file && file->commit());
  EXPECT_FALSE(std::filesystem::exists(path(".voxshell-1-2.tmp")));
  EXPECT_EQ(file_count(), 4) << "young, or somebody else's";
}

TEST_F(File, SweepsAtOnceWhatAWriterOfThisMachineLeft) {
  const pid_t child = ::fork();
  if (child == 0) {
    auto file = OutputFile::create(path("a"));
    ::_exit(file && file->append(bytes_of("torn")) ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  ASSERT_EQ(file_count(), 1) << "the writer left nothing";
  auto living = OutputFile::create(path("b"));
  ASSERT_TRUE(living);
  EXPECT_EQ(file_count(), 1);
  auto other = OutputFile::create(path("c"));
  ASSERT_TRUE(other && other->commit());
  ASSERT_TRUE(living->append(bytes_of("b")) && living->commit()) << "swept while it was alive";
  EXPECT_EQ(content("b"), "b");
  EXPECT_EQ(file_count(), 2);
}

TEST_F(File, IsReadFromAnyPlace) {
  std::ofstream(path("a")) << "0123456789";
  const auto file = InputFile::open(path("a"));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->size(), 10u);
  std::array<char, 4> text{};
  ASSERT_TRUE(file->read(3, std::as_writable_bytes(std::span(text))));
  EXPECT_EQ(std::string(text.begin(), text.end()), "3456");
  const auto beyond = file->read(8, std::as_writable_bytes(std::span(text)));
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::kFileAccess);
}

TEST_F(File, CannotBeReadWhereItIsNoRegularFile) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  for (const auto& [name, reason] :
       {std::pair{path("missing"), "No such file"}, std::pair{path(""), "it is a folder"},
        std::pair{path("pipe"), "not a regular file"},
        std::pair{std::string("/dev/zero"), "not a regular file"},
        std::pair{std::string(), "No such file"}}) {
    const auto file = InputFile::open(name);
    ASSERT_FALSE(file) << name;
    EXPECT_EQ(file.error().code, ErrorCode::kFileAccess);
    EXPECT_NE(file.error().message.find(reason), std::string::npos) << file.error().message;
  }
}

}  // namespace
}  // namespace voxshell::file_test
