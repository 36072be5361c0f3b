#include "landing/atlas/atlas_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <type_traits>

#include "common/error.hpp"
#include "common/files.hpp"

namespace ukemi::landing {

static_assert(std::is_trivially_copyable_v<AtlasHeader> && std::is_trivially_copyable_v<AtlasCell>);
static_assert(sizeof(AtlasHeader) == 576 && alignof(AtlasHeader) == 8, "the file's layout: a change is a new version");
static_assert(sizeof(AtlasCell) == 128 && sizeof(AtlasHeader) % alignof(AtlasCell) == 0);

namespace {

constexpr std::string_view kMagic = "ukemiatl";
constexpr std::size_t kChecked = offsetof(AtlasHeader, checksum) + sizeof(AtlasHeader::checksum);

template <std::size_t N>
void put(char (&to)[N], const std::string& text) {
  std::copy_n(text.begin(), std::min(N, text.size()), to);
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Throws InputError where the bytes are not a complete atlas that this machine can read.
void check(std::span<const std::byte> bytes, const std::string& path) {
  const auto fail = [&](const std::string& what) { throw InputError({path}, what); };
  if (bytes.size() < sizeof(AtlasHeader)) fail("no atlas: shorter than its header");
  AtlasHeader h;
  std::memcpy(&h, bytes.data(), sizeof h);
  if (std::string_view(h.magic, sizeof h.magic) != kMagic) fail("no atlas: it begins with other bytes");
  if (h.order != AtlasHeader::kLittleEndian || std::endian::native != std::endian::little)
    fail("written in another order of bytes: little-endian is needed, on a little-endian machine");
  if (h.version != AtlasHeader::kVersion)
    fail(fmt::format("an atlas of version {}: {} is needed", h.version, AtlasHeader::kVersion));
  if (h.size != bytes.size()) fail(fmt::format("{} bytes: its header says {}: cut or grown", bytes.size(), h.size));
  if (checksum(text_of(bytes).substr(kChecked)) != std::string_view(h.checksum, sizeof h.checksum))
    fail("its bytes are not those of its checksum");
  h.grid.validate();
  if (h.variables > kAtlasVariables || h.size != sizeof h + h.grid.size() * sizeof(AtlasCell))
    fail("its header contradicts itself");
}

}  // namespace

std::size_t Atlas::planned() const {
  return std::size_t(std::count_if(cells.begin(), cells.end(), [](auto& c) { return c.planned(); }));
}
std::size_t Atlas::none() const {
  return std::size_t(
      std::count_if(cells.begin(), cells.end(), [](auto& c) { return c.state == AtlasCell::State::kNone; }));
}

bool AtlasVariable::is(const Variable& v) const {
  AtlasVariable other{};
  put(other.name, v.name), put(other.unit, v.unit);
  return std::memcmp(this, &other, sizeof other) == 0;
}

AtlasHeader atlas_header(const AtlasRobot& robot, const AtlasOptions& options) {
  AtlasHeader h{};
  put(h.magic, std::string(kMagic));
  h.version = AtlasHeader::kVersion, h.order = AtlasHeader::kLittleEndian;
  put(h.identity, atlas_identity(robot, options));
  put(h.robot, robot.checksum());
  h.goal = std::uint64_t(options.robust.measure ? Goal::kRobust : options.search.goal);
  if (const auto& m = options.robust.measure) h.measure = std::uint64_t(m->kind), h.level = m->level;
  h.grid = options.grid;
  const std::vector<Variable> variables = robot.variables();
  h.variables = std::uint64_t(variables.size());
  for (std::size_t k = 0; k < variables.size(); ++k)
    put(h.variable[k].name, variables[k].name), put(h.variable[k].unit, variables[k].unit);
  return h;
}

std::string atlas_bytes(const Atlas& atlas) {
  const std::size_t cells = atlas.cells.size() * sizeof(AtlasCell);
  AtlasHeader h = atlas.header;
  h.size = sizeof h + cells;
  std::string out(h.size, '\0');
  if (cells > 0) std::memcpy(out.data() + sizeof h, atlas.cells.data(), cells);
  std::memcpy(out.data(), &h, sizeof h);
  put(h.checksum, checksum(std::string_view(out).substr(kChecked)));
  std::memcpy(out.data(), &h, sizeof h);
  return out;
}

Atlas atlas_of(std::span<const std::byte> bytes, const std::string& path) {
  check(bytes, path);
  Atlas out;
  std::memcpy(&out.header, bytes.data(), sizeof out.header);
  out.cells.resize(out.header.grid.size());
  std::memcpy(out.cells.data(), bytes.data() + sizeof out.header, out.cells.size() * sizeof(AtlasCell));
  return out;
}

MappedAtlas::MappedAtlas(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) {
    const std::string why = file < 0 ? std::strerror(errno) : "a regular file that is not empty is needed";
    if (file >= 0) ::close(file);
    throw InputError({path}, "cannot be mapped: " + why);
  }
  size_ = std::size_t(status.st_size);
  data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file, 0);
  const int error = errno;
  ::close(file);
  if (data_ == MAP_FAILED) throw InputError({path}, std::string("cannot be mapped: ") + std::strerror(error));
  try {
    check(bytes(), path);
  } catch (...) {
    ::munmap(data_, size_);
    throw;
  }
}

MappedAtlas::~MappedAtlas() { ::munmap(data_, size_); }

std::span<const AtlasCell> MappedAtlas::cells() const {
  return {reinterpret_cast<const AtlasCell*>(bytes().data() + sizeof(AtlasHeader)), header().grid.size()};
}

}  // namespace ukemi::landing
