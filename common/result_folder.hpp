// A folder that holds the results of one run at a time.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/files.hpp"

namespace ukemi {

/// The file of a set that is put in place last: where it exists, the set is complete.
inline constexpr const char* kSummaryFile = "summary.json";

/// The files of one run, exchanged as one. A kill at any moment leaves the earlier set or the new one whole.
///
/// The new files are written aside, into `.NAME.ukemi-part` beside the folder. Where the folder holds nothing but
/// results, the two are exchanged in one step. Where it holds other files too, or is where the program was started, the
/// new set is moved into it as `.ukemi-commit` in one step and takes its place file by file, without a summary until
/// the last; what a kill leaves of that, the next ResultFolder of this path finishes. Files under other names stay.
class ResultFolder {
 public:
  /// `names`: every name that such a run may write besides the summary; '#' stands for digits, as in "hit_#.csv".
  /// Throws InputError where the folder cannot be made or written in, or a folder has one of the names.
  ResultFolder(std::string path, std::vector<std::string> names);

  /// Throws InputError where `replace` would overwrite or remove the file, under whatever name it was read.
  void refuse_as_input(const ReadFile& file) const;
  /// Counts further files among those that `replace` removes: what an earlier run of another kind wrote.
  void adopt(const std::vector<std::string>& names);
  /// Removes the earlier results, the summary first.
  void withdraw() const;
  /// Replaces all earlier files under the names by these, which include a summary. Throws InputError with the system's
  /// reason and leaves the earlier files untouched.
  void replace(const std::map<std::string, std::string>& files) const;

  const std::string& path() const { return path_; }
  /// Whether a file of this name belongs to such a run.
  bool owns(const std::string& name) const;

 private:
  std::vector<std::string> existing() const;  ///< the names that exist in the folder
  bool holds_results_only(const std::string& folder) const;
  /// Swaps the two atomically, keeping the permissions of `folder`; false, and no change, where that is not possible.
  bool exchange(const std::string& staging, const std::string& folder) const;

  std::string path_;
  std::vector<std::string> names_;
};

}  // namespace ukemi
