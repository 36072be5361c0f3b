// Files of a test's own, and those of the laboratory.
#pragma once

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/error.hpp"

namespace test {

namespace fs = std::filesystem;

inline std::string read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("the test cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

/// `text` with its first `from`, which must be there, as `to`.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t i = text.find(from);
  if (i == std::string::npos) throw std::logic_error("the test replaces what is not there: " + from);
  return text.replace(i, from.size(), to);
}

/// A fresh folder that goes when the test does.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "ukemi-test-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ec;
    fs::remove_all(path_, ec);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string at(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(at(name), std::ios::binary) << bytes;
    return at(name);
  }
  /// Every file and folder below `name`, with its bytes.
  std::map<std::string, std::string> content(const std::string& name = "") const {
    std::map<std::string, std::string> out;
    for (const auto& e : fs::recursive_directory_iterator(path_ / name))
      out[fs::relative(e.path(), path_ / name).string()] = e.is_regular_file() ? read(e.path()) : "";
    return out;
  }

 private:
  fs::path path_;
};

/// One file, in a folder of its own.
struct File {
  Folder folder;
  std::string path;
  File(const std::string& name, const std::string& bytes) : path(folder.write(name, bytes)) {}
};

/// The text of the InputError that `act` throws; empty where it throws none.
template <class Act>
std::string refusal(Act&& act) {
  try {
    act();
  } catch (const ukemi::InputError& e) {
    return e.what();
  }
  return "";
}
/// The same without the folder's name; "no error" where it throws none.
template <class Act>
std::string error_of(const Folder& folder, Act&& act) {
  std::string text = refusal(act);
  if (text.empty()) return "no error";
  const std::string prefix = folder.at("");
  for (std::size_t i; (i = text.find(prefix)) != std::string::npos;) text.erase(i, prefix.size());
  return text;
}

/// A measured file that is not shipped; none, and a warning, where UKEMI_LAB_DATA does not name its folder.
inline std::optional<std::string> lab_file(const std::string& name) {
  const char* lab = std::getenv("UKEMI_LAB_DATA");
  if (lab && fs::exists(fs::path(lab) / name)) return fs::path(lab) / name;
  WARN("skipped: UKEMI_LAB_DATA does not name a folder with " << name);
  return std::nullopt;
}

}  // namespace test
