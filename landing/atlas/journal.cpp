#include <cstring>

#include "landing/atlas/atlas_file.hpp"

namespace ukemi::landing {

namespace {

struct Record {
  std::uint64_t drop = 0;
  AtlasCell cell;
};
static_assert(std::is_trivially_copyable_v<Record> && sizeof(Record) == 136);

std::string head_of(const std::string& identity) {
  std::string head = "ukemijr1" + identity;
  head.resize(24);
  return head;
}

}  // namespace

AtlasJournal::AtlasJournal(const std::string& path, const std::string& identity, std::span<AtlasCell> cells)
    : journal_(path, head_of(identity), sizeof(Record), "atlas (scene, actuator, grid, seed or effort)") {
  for (const std::string& bytes : journal_.records()) {
    Record r;
    std::memcpy(&r, bytes.data(), sizeof r);
    if (r.drop >= cells.size()) continue;
    cells[r.drop] = r.cell;
    ++taken_;
  }
}

void AtlasJournal::add(std::size_t drop, const AtlasCell& cell) {
  const Record r{.drop = drop, .cell = cell};
  journal_.add({reinterpret_cast<const char*>(&r), sizeof r});
}

}  // namespace ukemi::landing
