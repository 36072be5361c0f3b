// Results of a long run so far, on disk: a kill at any moment loses no record that was written.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ukemi {

/// A file of fixed-size records, each followed by its checksum, after a header that identifies the run. Locked by one
/// process at a time. Tests: test/unit/atlas.cpp.
class Journal {
 public:
  /// Reads the records of an earlier run, or starts the file; makes its folder. A truncated last record is dropped.
  /// Throws InputError where the header differs ("begun for another WHAT"), another process holds the lock, or it
  /// cannot be written. `what` names the subject, as "atlas (scene, grid or seed)".
  Journal(const std::string& path, std::string_view header, std::size_t record_size, const std::string& what);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Records of earlier runs, in their order.
  const std::vector<std::string>& records() const { return records_; }
  /// Throws InputError with the system's reason.
  void add(std::string_view record);
  /// The whole file.
  std::string bytes() const;

 private:
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_to_write() const;
  void write(std::string_view text) const;
  void read(std::string_view header, std::size_t record_size, const std::string& what);

  std::string path_;
  int file_ = -1;
  std::vector<std::string> records_;
};

}  // namespace ukemi
