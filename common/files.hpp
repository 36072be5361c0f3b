// Whole files: read once, with checks; written whole or not at all.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace ukemi {

/// Size of the largest file that is read [bytes].
inline constexpr std::uint64_t kLargestFile = std::uint64_t(4) << 30;

/// The bytes of a text file, its first `at_most`. Throws InputError as read_binary_file, on NUL or control bytes (with
/// their line and column), and on a line longer than `longest_line` bytes; reading stops at the first such fault.
std::string read_text_file(const std::string& path, std::size_t longest_line = 1 << 20,
                           std::size_t at_most = std::string::npos);

/// The bytes of any file, its first `at_most`. Throws InputError on a missing or unreadable file, a folder, a pipe or a
/// device, and beyond kLargestFile.
std::string read_binary_file(const std::string& path, std::size_t at_most = std::string::npos);

/// A file that was read to its end, with the checksum of its content.
struct ReadFile {
  std::string path;
  dev_t device;
  ino_t inode;
  std::string checksum;  ///< of the bytes read
};

/// While it lives, calls `callback` for every file that this thread reads to its end. Of several only the latest acts.
class ReadWatch {
 public:
  using Callback = std::function<void(const ReadFile&)>;
  explicit ReadWatch(Callback callback);
  ~ReadWatch();
  ReadWatch(const ReadWatch&) = delete;
  ReadWatch& operator=(const ReadWatch&) = delete;

 private:
  friend class Reader;
  Callback callback_;
  ReadWatch* outer_;
};

/// Writes `content` under a temporary name beside `path`, then renames it: never a partial file. Makes the folder where
/// it is missing. Throws InputError naming the path and the system's reason.
void write_file(const std::string& path, const std::string& content);

/// Writes a file that is opened with `mode` of std::fopen; 0, or the system's error code.
int write_bytes(const std::string& path, const char* mode, std::string_view content);

/// Checks, before any work, that a folder can be made and written in; makes nothing. Throws InputError.
void require_writable_folder(const std::string& folder);

/// FNV-1a checksum with 64 bits, as 16 hexadecimal digits, for provenance.
std::string checksum(std::string_view bytes);

}  // namespace ukemi
