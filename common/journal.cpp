#include "common/journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "common/error.hpp"
#include "common/files.hpp"

namespace ukemi {

namespace {

constexpr std::size_t kChecksum = 16;  // digits of `checksum` after each record

}  // namespace

Journal::Journal(const std::string& path, std::string_view header, std::size_t record_size, const std::string& what)
    : path_(path) {
  std::error_code ec;
  if (const auto folder = std::filesystem::path(path).parent_path(); !folder.empty())
    std::filesystem::create_directories(folder, ec);
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) fail_to_write();
  try {
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) fail("another run is at work on it: another output folder is needed");
    read(header, record_size, what);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() { ::close(file_); }

void Journal::fail(const std::string& what) const { throw InputError({path_}, what); }
void Journal::fail_to_write() const { fail(std::string("cannot be written: ") + std::strerror(errno)); }

void Journal::read(std::string_view header, std::size_t record_size, const std::string& what) {
  const std::string content = bytes();
  std::size_t valid = 0;
  if (content.size() >= header.size()) {
    if (content.compare(0, header.size(), header) != 0)
      fail("begun for another " + what + ": another output folder, or its removal, is needed");
    for (valid = header.size(); valid + record_size + kChecksum <= content.size(); valid += record_size + kChecksum) {
      const std::string record = content.substr(valid, record_size);
      if (content.compare(valid + record_size, kChecksum, checksum(record)) != 0) break;
      records_.push_back(record);
    }
  }
  if (::ftruncate(file_, off_t(valid)) != 0 || ::lseek(file_, off_t(valid), SEEK_SET) < 0) fail_to_write();
  if (valid == 0) write(header);
}

void Journal::add(std::string_view record) { write(std::string(record) + checksum(record)); }

void Journal::write(std::string_view text) const {
  errno = ENOSPC;  // reason of a short write
  if (::write(file_, text.data(), text.size()) != ssize_t(text.size())) fail_to_write();
}

std::string Journal::bytes() const {
  std::string out(std::size_t(std::max<off_t>(0, ::lseek(file_, 0, SEEK_END))), '\0');
  std::size_t got = 0;
  for (ssize_t n = 0; (n = ::pread(file_, out.data() + got, out.size() - got, off_t(got))) > 0;) got += std::size_t(n);
  out.resize(got);
  return out;
}

}  // namespace ukemi
