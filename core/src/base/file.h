#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "voxshell/result.h"

namespace voxshell {

/// A regular file open for reading. Errors: kFileAccess.
class InputFile {
 public:
  static Result<InputFile> open(const std::string& path);

  InputFile(InputFile&& other) noexcept;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile();

  std::uint64_t size() const { return size_; }  ///< bytes, when it was opened

  /// Fills `bytes` from a place in the file.
  Result<std::monostate> read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  InputFile(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  int descriptor_;
  std::uint64_t size_;
};

/// A file that appears under its name whole, or not at all, whatever happens on the way: it is
/// written under another name in the same folder, flushed to the disk and renamed. Where the name
/// is a link's, the file that it leads to is replaced. Anything there but a regular file is
/// refused. Files that killed writers left in the folder are removed by the next writer: at once if
/// they ran on this machine, otherwise after ten minutes. Errors: kFileAccess.
class OutputFile {
 public:
  /// Names of unfinished files begin with this, and end in kUnfinishedSuffix.
  static constexpr const char* kUnfinishedPrefix = ".voxshell-";
  static constexpr const char* kUnfinishedSuffix = ".tmp";

  static Result<OutputFile> create(const std::string& path);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();  ///< removes what was not committed

  Result<std::monostate> append(std::span<const std::byte> bytes);

  /// Gives the file its name, in place of one that had it before.
  Result<std::monostate> commit();

 private:
  OutputFile(int descriptor, std::string unfinished_path, std::string path)
      : descriptor_(descriptor),
        unfinished_path_(std::move(unfinished_path)),
        path_(std::move(path)) {}

  void close_and_remove();

  int descriptor_;
  std::string unfinished_path_;
  std::string path_;
};

}  // namespace voxshell
