// What a long run has done so far, on the disk: a kill at any moment costs no record that is in it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ukemi {

/// A file of records of one size, each with its checksum, behind a head that says what they are of. One process at a
/// time has it. Tests: test/unit/atlas.cpp.
class Journal {
 public:
  /// Reads what an earlier run left there, else begins; makes the folder. What a kill cut off at the end is dropped.
  /// Throws InputError where it has another head ("begun for another WHAT"), another process has it, or it cannot be
  /// written. `what`: of what it is, as "atlas (scene, grid or seed)".
  Journal(const std::string& path, std::string_view head, std::size_t record_size, const std::string& what);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Records of earlier runs, in their order.
  const std::vector<std::string>& records() const { return records_; }
  /// Throws InputError with the system's reason.
  void add(std::string_view record);
  /// All that it holds.
  std::string bytes() const;

 private:
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_to_write() const;
  void read(std::string_view head, std::size_t record_size, const std::string& what);

  std::string path_;
  int file_ = -1;
  std::vector<std::string> records_;
};

}  // namespace ukemi
