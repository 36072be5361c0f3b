#include "common/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"

namespace ukemi {

namespace fs = std::filesystem;

namespace {

void make_folder(const fs::path& folder) {
  std::error_code ec;
  if (folder.empty() || fs::is_directory(folder, ec)) return;
  fs::create_directories(folder, ec);
  if (ec) throw InputError({folder.string()}, "the folder cannot be made: " + ec.message());
}

}  // namespace

std::string read_binary_file(const std::string& path, std::size_t at_most) {
  std::error_code ec;
  if (!fs::exists(path, ec)) throw InputError({path}, "no such file");
  if (fs::is_directory(path, ec)) throw InputError({path}, "is a folder: a file is needed");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError({path}, std::string("cannot be read: ") + std::strerror(errno));
  std::string text;
  std::array<char, 1 << 16> block;
  while (in && text.size() < at_most) {
    in.read(block.data(), std::streamsize(std::min(block.size(), at_most - text.size())));
    text.append(block.data(), std::size_t(in.gcount()));
  }
  if (in.bad()) throw InputError({path}, "cannot be read to its end");
  return text;
}

std::string read_text_file(const std::string& path, std::size_t longest_line, std::size_t at_most) {
  std::string text = read_binary_file(path, at_most);
  long line = 1;
  std::size_t start = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '\n') {
      ++line, start = i + 1;
    } else if (c < 32 && c != '\t' && c != '\r' && c != '\f') {
      throw InputError({path, line, long(i - start) + 1}, fmt::format("byte 0x{:02x}: not a text file", c));
    } else if (i - start >= longest_line) {
      throw InputError({path, line, long(i - start) + 1},
                       fmt::format("the line is longer than {} bytes", longest_line));
    }
  }
  return text;
}

void write_file(const std::string& path, const std::string& content) {
  const fs::path target(path);
  make_folder(target.parent_path());
  const std::string temporary = fmt::format("{}.{}.part", path, ::getpid());
  std::FILE* out = std::fopen(temporary.c_str(), "wb");
  if (!out) throw InputError({path}, std::string("cannot be written: ") + std::strerror(errno));
  const bool written = std::fwrite(content.data(), 1, content.size(), out) == content.size();
  const int code = written ? 0 : errno;
  const bool closed = std::fclose(out) == 0;
  std::error_code ec;
  if (written && closed) fs::rename(temporary, target, ec);
  if (!written || !closed || ec) {
    const std::string reason = ec ? ec.message() : std::strerror(code ? code : errno);
    fs::remove(temporary, ec);
    throw InputError({path}, "cannot be written: " + reason);
  }
}

void require_writable_folder(const std::string& folder) {
  // The nearest folder that exists decides; nothing is made, so that a later error leaves nothing behind.
  std::error_code ec;
  fs::path p = fs::absolute(folder, ec);
  while (!fs::exists(p, ec) && p.has_parent_path() && p != p.parent_path()) p = p.parent_path();
  if (!fs::is_directory(p, ec))
    throw InputError({folder}, "the output folder cannot be made: " + p.string() + " is not a folder");
  const std::string probe = (p / fmt::format(".ukemi-{}.part", ::getpid())).string();
  std::FILE* out = std::fopen(probe.c_str(), "wb");
  if (!out) throw InputError({folder}, std::string("the output folder cannot be written: ") + std::strerror(errno));
  std::fclose(out);
  std::remove(probe.c_str());
}

std::string checksum(const std::string& path) {
  std::uint64_t h = 14695981039346656037ull;
  for (const unsigned char c : read_binary_file(path)) h = (h ^ c) * 1099511628211ull;
  return fmt::format("{:016x}", h);
}

}  // namespace ukemi
