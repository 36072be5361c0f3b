// Runs the real program as a user does, and looks at what it left.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace cli {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

inline std::string read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("the test cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A shipped file.
inline std::string dataset(const std::string& name) { return std::string(UKEMI_DATASETS) + "/" + name; }

/// The eight impact trials.
inline Arguments impact_trials() {
  Arguments out;
  for (int i = 1; i <= 8; ++i) out.push_back(dataset("impact/trial_" + std::to_string(i) + ".csv"));
  return out;
}

/// `text` with its first `from`, which must be there, as `to`.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t i = text.find(from);
  if (i == std::string::npos) throw std::logic_error("the test replaces what is not there: " + from);
  return text.replace(i, from.size(), to);
}

inline Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A fresh folder that goes when the test does.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "ukemi-cli-XXXXXX").string();
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

struct Result {
  int code = -1;
  std::string out, err;  ///< stdout, stderr
};

inline std::string shell_quoted(const std::string& s) {
  std::string out = "'";
  for (const char c : s) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// `ukemi ARGUMENTS...` started in the folder `directory`. What it prints goes to files outside of it.
inline Result run(const Arguments& arguments, const std::string& directory) {
  const Folder capture;
  std::string command = "cd " + shell_quoted(directory) + " && exec timeout 60 " + shell_quoted(UKEMI_PROGRAM);
  for (const std::string& a : arguments) command += " " + shell_quoted(a);
  command += " >" + capture.at("out") + " 2>" + capture.at("err") + " </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(capture.at("out")), read(capture.at("err"))};
}

}  // namespace cli
