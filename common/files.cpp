#include "common/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "common/error.hpp"

namespace ukemi {

namespace fs = std::filesystem;

namespace {

thread_local ReadWatch* innermost = nullptr;

void make_folder(const fs::path& folder) {
  std::error_code ec;
  if (folder.empty() || fs::is_directory(folder, ec)) return;
  fs::create_directories(folder, ec);
  if (ec) throw InputError({folder.string()}, "the folder cannot be made: " + ec.message());
}

/// Checks a text block by block as it is read.
class TextCheck {
 public:
  TextCheck(const std::string& path, std::size_t longest_line) : path_(path), longest_line_(longest_line) {}

  void operator()(std::string_view block) {
    for (const char byte : block) {
      const auto c = static_cast<unsigned char>(byte);
      if (c == '\n') {
        ++line_, column_ = 0;
        continue;
      }
      ++column_;
      if (c < 32 && c != '\t' && c != '\r' && c != '\f')
        throw InputError({path_, line_, column_}, fmt::format("byte 0x{:02x}: not a text file", c));
      if (column_ > long(longest_line_))
        throw InputError({path_, line_, column_}, fmt::format("the line is longer than {} bytes", longest_line_));
    }
  }

 private:
  const std::string& path_;
  std::size_t longest_line_;
  long line_ = 1, column_ = 0;
};

}  // namespace

ReadWatch::ReadWatch(Callback callback) : callback_(std::move(callback)), outer_(innermost) { innermost = this; }
ReadWatch::~ReadWatch() { innermost = outer_; }

/// An open regular file; opening never blocks on a pipe or a device.
class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {
    file_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0) fail(errno == ENOENT || errno == ENOTDIR ? "no such file" : reason());
    try {
      if (::fstat(file_, &stat_) != 0) fail(reason());
      if (S_ISDIR(stat_.st_mode)) fail("is a folder: a file is needed");
      if (!S_ISREG(stat_.st_mode)) fail("is a pipe or a device: a regular file is needed");
      require_size(std::uint64_t(stat_.st_size));
    } catch (...) {
      ::close(file_);
      throw;
    }
  }
  ~Reader() { ::close(file_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Its first `at_most` bytes, shown to `check` block by block.
  template <class Check>
  std::string read(std::size_t at_most, Check&& check) {
    std::string bytes;
    bytes.reserve(std::min(at_most, std::size_t(stat_.st_size)));
    std::vector<char> block(1 << 18);
    while (bytes.size() < at_most) {
      const ssize_t n = ::read(file_, block.data(), std::min(block.size(), at_most - bytes.size()));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(reason());
      if (n == 0) {
        notify_watch(bytes);
        break;
      }
      check(std::string_view(block.data(), std::size_t(n)));
      bytes.append(block.data(), std::size_t(n));
      require_size(bytes.size());  // it may grow, or stat gives no size (/proc)
    }
    return bytes;
  }

 private:
  static std::string reason() { return std::string("cannot be read: ") + std::strerror(errno); }
  [[noreturn]] void fail(const std::string& what) const { throw InputError({path_}, what); }
  void require_size(std::uint64_t size) const {
    if (size > kLargestFile) fail(fmt::format("{} bytes: a file of at most {} is read", size, kLargestFile));
  }
  void notify_watch(const std::string& bytes) const {
    if (innermost) innermost->callback_({path_, stat_.st_dev, stat_.st_ino, checksum(bytes)});
  }

  const std::string& path_;
  int file_ = -1;
  struct stat stat_ {};
};

std::string read_binary_file(const std::string& path, std::size_t at_most) {
  return Reader(path).read(at_most, [](std::string_view) {});
}

std::string read_text_file(const std::string& path, std::size_t longest_line, std::size_t at_most) {
  return Reader(path).read(at_most, TextCheck(path, longest_line));
}

int write_bytes(const std::string& path, const char* mode, std::string_view content) {
  std::FILE* out = std::fopen(path.c_str(), mode);
  if (!out) return errno;
  errno = ENOSPC;  // reason of a short write
  const int code = std::fwrite(content.data(), 1, content.size(), out) == content.size() ? 0 : errno;
  return std::fclose(out) != 0 && code == 0 ? errno : code;
}

void write_file(const std::string& path, const std::string& content) {
  const fs::path target(path);
  make_folder(target.parent_path());
  const std::string temporary = fmt::format("{}.{}.part", path, ::getpid());
  std::error_code ec(write_bytes(temporary, "wb", content), std::generic_category()), ignored;
  if (!ec) fs::rename(temporary, target, ec);
  if (!ec) return;
  fs::remove(temporary, ignored);
  throw InputError({path}, "cannot be written: " + ec.message());
}

void require_writable_folder(const std::string& folder) {
  // The nearest folder that exists decides; nothing is made, so that a later error leaves no folder there.
  std::error_code ec;
  fs::path p = fs::absolute(folder, ec);
  while (!fs::exists(p, ec) && p.has_parent_path() && p != p.parent_path()) p = p.parent_path();
  if (!fs::is_directory(p, ec))
    throw InputError({folder}, "the output folder cannot be made: " + p.string() + " is not a folder");
  if (::faccessat(AT_FDCWD, p.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    throw InputError({folder}, std::string("the output folder cannot be written: ") + std::strerror(errno));
}

std::string checksum(std::string_view bytes) {
  std::uint64_t h = 14695981039346656037ull;
  for (const unsigned char c : bytes) h = (h ^ c) * 1099511628211ull;
  return fmt::format("{:016x}", h);
}

}  // namespace ukemi
