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

constexpr std::size_t kChecksum = 16;  // digits of `checksum` behind each record

}  // namespace

Journal::Journal(const std::string& path, std::string_view head, std::size_t record_size, const std::string& what)
    : path_(path) {
  std::error_code ec;
  if (const auto folder = std::filesystem::path(path).parent_path(); !folder.empty())
    std::filesystem::create_directories(folder, ec);
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) fail_to_write();
  try {
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) fail("another run is at work on it: another output folder is needed");
    read(head, record_size, what);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() { ::close(file_); }

void Journal::fail(const std::string& what) const { throw InputError({path_}, what); }
void Journal::fail_to_write() const { fail(std::string("cannot be written: ") + std::strerror(errno)); }

void Journal::read(std::string_view head, std::size_t record_size, const std::string& what) {
  const std::string found = bytes();
  std::size_t whole = 0;
  if (found.size() >= head.size()) {
    if (found.compare(0, head.size(), head) != 0)
      fail("begun for another " + what + ": another output folder, or its removal, is needed");
    for (whole = head.size(); whole + record_size + kChecksum <= found.size(); whole += record_size + kChecksum) {
      const std::string record = found.substr(whole, record_size);
      if (found.compare(whole + record_size, kChecksum, checksum(record)) != 0) break;
      records_.push_back(record);
    }
  }
  if (::ftruncate(file_, off_t(whole)) != 0 || ::lseek(file_, off_t(whole), SEEK_SET) < 0) fail_to_write();
  if (whole == 0 && ::write(file_, head.data(), head.size()) != ssize_t(head.size())) fail_to_write();
}

void Journal::add(std::string_view record) {
  const std::string text = std::string(record) + checksum(record);
  errno = ENOSPC;  // of a write that is short
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
