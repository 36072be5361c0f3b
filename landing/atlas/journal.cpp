#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "common/error.hpp"
#include "common/files.hpp"
#include "landing/atlas/atlas_file.hpp"

namespace ukemi::landing {

namespace {

struct Begin {
  char magic[8] = {'u', 'k', 'e', 'm', 'i', 'j', 'r', '1'};
  char identity[16] = {};
};

struct Entry {
  std::uint64_t drop = 0;
  AtlasCell cell;
  char checksum[16] = {};
};
static_assert(std::is_trivially_copyable_v<Entry> && sizeof(Entry) == 152 && sizeof(Begin) == 24);

std::string checksum_of(const Entry& e) {
  return checksum({reinterpret_cast<const char*>(&e), offsetof(Entry, checksum)});
}

}  // namespace

AtlasJournal::AtlasJournal(const std::string& path, const std::string& identity, std::span<AtlasCell> cells)
    : path_(path) {
  std::error_code ec;
  if (const auto folder = std::filesystem::path(path).parent_path(); !folder.empty())
    std::filesystem::create_directories(folder, ec);
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) fail(std::string("cannot be written: ") + std::strerror(errno));
  try {
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) fail("another run is at work on it: another output folder is needed");
    read_cells(identity, cells);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

AtlasJournal::~AtlasJournal() { ::close(file_); }

void AtlasJournal::fail(const std::string& what) const { throw InputError({path_}, what); }

/// What a kill cut off at its end is gone.
void AtlasJournal::read_cells(const std::string& identity, std::span<AtlasCell> cells) {
  const std::string found = bytes();
  Begin begin;
  std::memcpy(begin.identity, identity.data(), std::min(identity.size(), sizeof begin.identity));
  std::size_t whole = 0;
  if (found.size() >= sizeof begin) {
    if (std::memcmp(found.data(), &begin, sizeof begin) != 0)
      fail(
          "begun for another atlas (scene, actuator, grid, seed or effort): another output folder, or its removal, is "
          "needed");
    whole = sizeof begin;
    for (Entry e; whole + sizeof e <= found.size(); whole += sizeof e) {
      std::memcpy(&e, found.data() + whole, sizeof e);
      if (checksum_of(e) != std::string_view(e.checksum, sizeof e.checksum) || e.drop >= cells.size()) break;
      cells[e.drop] = e.cell;
      ++taken_;
    }
  }
  if (::ftruncate(file_, off_t(whole)) != 0 || ::lseek(file_, off_t(whole), SEEK_SET) < 0)
    fail(std::string("cannot be written: ") + std::strerror(errno));
  if (whole == 0 && ::write(file_, &begin, sizeof begin) != ssize_t(sizeof begin))
    fail(std::string("cannot be written: ") + std::strerror(errno));
}

void AtlasJournal::add(std::size_t drop, const AtlasCell& cell) {
  Entry e{.drop = drop, .cell = cell};
  std::memcpy(e.checksum, checksum_of(e).data(), sizeof e.checksum);
  errno = ENOSPC;  // of a write that is short
  if (::write(file_, &e, sizeof e) != ssize_t(sizeof e))
    fail(std::string("cannot be written: ") + std::strerror(errno));
}

std::string AtlasJournal::bytes() const {
  std::string out(std::size_t(std::max<off_t>(0, ::lseek(file_, 0, SEEK_END))), '\0');
  std::size_t got = 0;
  for (ssize_t n = 0; (n = ::pread(file_, out.data() + got, out.size() - got, off_t(got))) > 0;) got += std::size_t(n);
  out.resize(got);
  return out;
}

}  // namespace ukemi::landing
