// An atlas as a file that is mapped, not parsed: a header, then a cell for each drop of the grid, all at fixed places.
//
// Little-endian, doubles as IEEE 754; a machine of the other kind refuses it. The header says its version, its size and
// the checksum of all that stands behind it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/journal.hpp"
#include "landing/atlas/atlas.hpp"

namespace ukemi::landing {

/// A name with its unit, filled up by zeros; what is longer is cut.
struct AtlasVariable {
  char name[24], unit[8];
  bool is(const Variable& v) const;
};

struct AtlasHeader {
  static constexpr std::uint32_t kVersion = 2, kLittleEndian = 0x01020304;
  char magic[8];          ///< "ukemiatl"
  std::uint32_t version;  ///< kVersion
  std::uint32_t order;    ///< kLittleEndian as the machine that wrote it stores it
  std::uint64_t size;     ///< of the file [bytes]
  char checksum[16];      ///< FNV-1a, 64 bits in hexadecimal digits, of all bytes behind it
  char identity[16];      ///< see atlas_identity
  char robot[16];         ///< see AtlasRobot::checksum
  std::uint64_t goal;     ///< Goal: what AtlasCell::value is
  std::uint64_t measure;  ///< under scatter, Measure::Kind, and its level
  double level;
  AtlasGrid grid;
  SafestMotion safest;
  std::uint64_t variables;  ///< of the motion space: so many of AtlasCell::values hold
  AtlasVariable variable[kAtlasVariables];
};

/// What is written, and read back.
struct Atlas {
  AtlasHeader header{};
  std::vector<AtlasCell> cells;

  std::size_t planned() const;  ///< drops with a motion
  std::size_t none() const;     ///< without one
  std::size_t open() const { return cells.size() - planned() - none(); }
};

/// A header for what is to be planned; size and checksum follow when it is written.
[[nodiscard]] AtlasHeader atlas_header(const AtlasRobot& robot, const AtlasOptions& options);
/// Its bytes as a file has them.
[[nodiscard]] std::string atlas_bytes(const Atlas& atlas);
/// The same back. Throws InputError "PATH: ..." for what is no atlas, of another version or machine, cut or changed.
[[nodiscard]] Atlas atlas_of(std::span<const std::byte> bytes, const std::string& path);

/// The same in place, read only.
class MappedAtlas {
 public:
  /// Throws InputError as above, and where it cannot be opened.
  explicit MappedAtlas(const std::string& path);
  ~MappedAtlas();
  MappedAtlas(const MappedAtlas&) = delete;
  MappedAtlas& operator=(const MappedAtlas&) = delete;

  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }
  const AtlasHeader& header() const { return *static_cast<const AtlasHeader*>(data_); }
  std::span<const AtlasCell> cells() const;

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Cells as they are planned, on the disk before the next one is begun.
class AtlasJournal {
 public:
  /// Takes what an earlier run left there into `cells`, else begins. Throws InputError as Journal.
  AtlasJournal(const std::string& path, const std::string& identity, std::span<AtlasCell> cells);

  /// Throws InputError with the system's reason.
  void add(std::size_t drop, const AtlasCell& cell);
  std::size_t taken() const { return taken_; }  ///< cells of an earlier run
  /// All that it holds.
  std::string bytes() const { return journal_.bytes(); }

 private:
  Journal journal_;
  std::size_t taken_ = 0;
};

}  // namespace ukemi::landing
