// File format of an atlas, mapped into memory: a header, then a cell for each drop of the grid, at fixed offsets.
//
// Little-endian, doubles as IEEE 754; refused on a big-endian machine. The header has the version, the size, and the
// checksum of all bytes after it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/journal.hpp"
#include "landing/atlas/atlas.hpp"

namespace ukemi::landing {

/// A name with its unit, padded with zeros or truncated.
struct AtlasVariable {
  char name[24], unit[8];
  bool is(const Variable& v) const;
};

struct AtlasHeader {
  static constexpr std::uint32_t kVersion = 2, kLittleEndian = 0x01020304;
  char magic[8];          ///< "ukemiatl"
  std::uint32_t version;  ///< kVersion
  std::uint32_t order;    ///< kLittleEndian in the byte order of the writing machine
  std::uint64_t size;     ///< of the file [bytes]
  char checksum[16];      ///< FNV-1a, 64 bits in hexadecimal digits, of all bytes after it
  char identity[16];      ///< see atlas_identity
  char robot[16];         ///< see AtlasRobot::checksum
  std::uint64_t goal;     ///< Goal of AtlasCell::value
  std::uint64_t measure;  ///< under scatter, Measure::Kind, and its level
  double level;
  AtlasGrid grid;
  SafestMotion safest;
  std::uint64_t variables;  ///< of the motion space: number of AtlasCell::values in use
  AtlasVariable variable[kAtlasVariables];
};

/// Header and cells in memory.
struct Atlas {
  AtlasHeader header{};
  std::vector<AtlasCell> cells;

  std::size_t planned() const;  ///< drops with a motion
  std::size_t none() const;     ///< without one
  std::size_t open() const { return cells.size() - planned() - none(); }
};

/// The header of an atlas to be planned; atlas_bytes sets size and checksum.
[[nodiscard]] AtlasHeader atlas_header(const AtlasRobot& robot, const AtlasOptions& options);
/// The contents of its file.
[[nodiscard]] std::string atlas_bytes(const Atlas& atlas);
/// The inverse. Throws InputError "PATH: ..." for no atlas, another version or byte order, a truncated or changed file.
[[nodiscard]] Atlas atlas_of(std::span<const std::byte> bytes, const std::string& path);

/// A mapped atlas, read only.
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

/// Journal of an atlas: each planned cell is on the disk before the next one begins.
class AtlasJournal {
 public:
  /// Restores the cells of an earlier run into `cells`, or begins a journal. Throws InputError as Journal.
  AtlasJournal(const std::string& path, const std::string& identity, std::span<AtlasCell> cells);

  /// Throws InputError with the system's reason.
  void add(std::size_t drop, const AtlasCell& cell);
  std::size_t taken() const { return taken_; }  ///< cells of an earlier run
  /// Its contents.
  std::string bytes() const { return journal_.bytes(); }

 private:
  Journal journal_;
  std::size_t taken_ = 0;
};

}  // namespace ukemi::landing
