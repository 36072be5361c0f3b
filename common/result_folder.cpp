#include "common/result_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

#include "common/error.hpp"

namespace ukemi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kCommit = ".ukemi-commit";
constexpr const char* kRemovedList = ".gone";  ///< in kCommit: names of the earlier files to remove, one a line

/// '#' in a pattern stands for one digit or more.
bool matches(std::string_view pattern, std::string_view name) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  while (!pattern.empty() && !name.empty()) {
    if (pattern[0] == '#' ? !digit(name[0]) : pattern[0] != name[0]) return false;
    if (pattern[0] == '#')
      while (name.size() > 1 && digit(name[1])) name.remove_prefix(1);
    pattern.remove_prefix(1), name.remove_prefix(1);
  }
  return pattern.empty() && name.empty();
}

std::optional<struct stat> stat_of(const fs::path& path) {
  struct stat s {};
  return ::stat(path.c_str(), &s) == 0 ? std::optional(s) : std::nullopt;
}
bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

[[noreturn]] void fail(const fs::path& path, int code) {
  throw InputError({path.string()}, std::string("cannot be written: ") + std::strerror(code));
}

/// Moves the new set of `folder` into place; also finishes an exchange that was killed.
void finish_commit(const fs::path& folder) {
  const fs::path commit = folder / kCommit;
  std::error_code ec;
  if (!fs::is_directory(commit, ec)) return;
  if (fs::exists(commit / kSummaryFile, ec)) fs::remove(folder / kSummaryFile, ec);
  std::ifstream removed(commit / kRemovedList);
  for (std::string name; std::getline(removed, name);)
    if (name.find('/') == std::string::npos) fs::remove(folder / name, ec);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(commit, ec)) names.push_back(entry.path().filename().string());
  std::stable_partition(names.begin(), names.end(), [](const std::string& n) { return n != kSummaryFile; });
  for (const std::string& name : names) {
    if (name == kRemovedList) continue;
    fs::rename(commit / name, folder / name, ec);
    const bool done = !ec || ec == std::errc::no_such_file_or_directory;  // by another process
    if (!done) throw InputError({(folder / name).string()}, "cannot be written: " + ec.message());
  }
  fs::remove_all(commit, ec);
}

/// A folder locked by this process, where the files of `target` are written first. Emptied at the start; removed in the
/// end, if it has not been moved away.
class StagingFolder {
 public:
  StagingFolder(fs::path path, fs::path target) : path_(std::move(path)), target_(std::move(target)) {
    while (!claim()) continue;
  }
  ~StagingFolder() {
    std::error_code ec;
    fs::remove_all(path_, ec);
    ::close(lock_);
  }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  void write(const std::string& name, const std::string& content) const {
    if (const int code = write_bytes((path_ / name).string(), "wbx", content)) fail(target_ / name, code);
  }
  const fs::path& path() const { return path_; }

 private:
  /// Makes and locks the folder, or takes it over from a process that has ended; false where another has replaced it.
  bool claim() {
    if (::mkdir(path_.c_str(), 0777) != 0 && errno != EEXIST) fail(target_, errno);
    lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock_ < 0 && errno == ENOENT) return false;
    if (lock_ < 0) fail(target_, errno);
    while (::flock(lock_, LOCK_EX) != 0 && errno == EINTR) continue;  // a living owner ends soon
    struct stat mine {};
    ::fstat(lock_, &mine);
    const auto entry_stat = stat_of(path_);
    if (!entry_stat || !same_file(*entry_stat, mine)) {
      ::close(lock_);
      return false;
    }
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(path_, ec)) fs::remove_all(entry.path(), ec);
    return true;
  }

  fs::path path_, target_;
  int lock_ = -1;
};

/// The absolute path with symbolic links resolved and no trailing '/'.
fs::path resolved(const std::string& path) {
  std::error_code ec;
  const fs::path p = fs::weakly_canonical(fs::absolute(path), ec);
  return p.has_filename() ? p : p.parent_path();
}

/// Where the new set of an absolute, resolved `folder` is written: beside it, if on the same file system and writable;
/// else inside of it.
fs::path staging_path(const fs::path& folder) {
  const auto inside = stat_of(folder), beside = stat_of(folder.parent_path());
  const bool mounted = inside && beside && inside->st_dev != beside->st_dev;
  if (!folder.has_filename() || mounted || ::faccessat(AT_FDCWD, folder.parent_path().c_str(), W_OK, AT_EACCESS) != 0)
    return folder / ".ukemi-part";
  return folder.parent_path() / ("." + folder.filename().string() + ".ukemi-part");
}

/// Gives `made` the owner and the permissions of `folder`; false where that fails, or `folder` has an ACL.
bool copy_permissions(const fs::path& made, const fs::path& folder) {
  const auto target = stat_of(folder);
  if (!target || ::getxattr(folder.c_str(), "system.posix_acl_access", nullptr, 0) > 0) return false;
  const auto current = stat_of(made);
  const bool owner = current && current->st_uid == target->st_uid && current->st_gid == target->st_gid;
  if (!owner && ::chown(made.c_str(), target->st_uid, target->st_gid) != 0) return false;
  return ::chmod(made.c_str(), target->st_mode & 07777) == 0;
}

}  // namespace

ResultFolder::ResultFolder(std::string path, std::vector<std::string> names)
    : path_(std::move(path)), names_(std::move(names)) {
  names_.push_back(kSummaryFile);
  require_writable_folder(path_);
  finish_commit(path_);
  for (const std::string& name : existing())
    if (fs::is_directory(fs::path(path_) / name))
      throw InputError({(fs::path(path_) / name).string()}, "is a folder: the results need this name for a file");
}

bool ResultFolder::owns(const std::string& name) const {
  return std::any_of(names_.begin(), names_.end(), [&](const std::string& pattern) { return matches(pattern, name); });
}

std::vector<std::string> ResultFolder::existing() const {
  std::vector<std::string> out;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(path_, ec))
    if (owns(entry.path().filename().string())) out.push_back(entry.path().filename().string());
  return out;
}

bool ResultFolder::holds_results_only(const std::string& folder) const {
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(folder, ec))
    if (!owns(entry.path().filename().string()) || entry.is_directory(ec)) return false;
  return !ec;
}

bool ResultFolder::exchange(const std::string& staging, const std::string& folder) const {
  const auto here = stat_of("."), target = stat_of(folder);
  const bool started_here = here && target && same_file(*here, *target);
  if (started_here || !holds_results_only(folder) || !copy_permissions(staging, folder)) return false;
  const auto swap = [&] {
    return ::renameat2(AT_FDCWD, staging.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0;
  };
  if (!swap()) return false;
  return holds_results_only(staging) || !swap();  // undone where another file has appeared meanwhile
}

void ResultFolder::refuse_as_input(const ReadFile& file) const {
  for (const std::string& name : existing()) {
    const auto entry_stat = stat_of(fs::path(path_) / name);
    if (entry_stat && entry_stat->st_dev == file.device && entry_stat->st_ino == file.inode)
      throw InputError({file.path}, "this run would write over it, as " + (fs::path(path_) / name).string() +
                                        ": another output folder is needed");
  }
}

void ResultFolder::adopt(const std::vector<std::string>& names) {
  names_.insert(names_.end(), names.begin(), names.end());
}

void ResultFolder::withdraw() const {
  std::error_code ec;
  fs::remove(fs::path(path_) / kSummaryFile, ec);
  for (const std::string& name : existing()) fs::remove(fs::path(path_) / name, ec);
}

void ResultFolder::replace(const std::map<std::string, std::string>& files) const {
  std::error_code ec;
  const fs::path folder = resolved(path_);
  const bool exists = fs::exists(folder, ec);
  fs::create_directories(folder.parent_path(), ec);
  const StagingFolder staging(staging_path(folder), path_);
  for (const auto& [name, content] : files) staging.write(name, content);

  if (staging.path().parent_path() == folder.parent_path()) {
    if (!exists && ::rename(staging.path().c_str(), folder.c_str()) == 0) return;
    if (exchange(staging.path().string(), folder.string())) return;
  }
  std::string removed;
  for (const std::string& name : existing())
    if (!files.count(name)) removed += name + "\n";
  staging.write(kRemovedList, removed);
  finish_commit(folder);
  if (::rename(staging.path().c_str(), (folder / kCommit).c_str()) != 0) fail(folder, errno);
  finish_commit(folder);
}

}  // namespace ukemi
