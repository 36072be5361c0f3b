#include "tools/report/page/gnuplot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/text.hpp"

extern char** environ;

namespace ukemi::tools {

namespace {

namespace fs = std::filesystem;

/// A temporary folder, removed by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code ignored;
    path_ = (fs::temp_directory_path(ignored) / "ukemi-XXXXXX").string();
    made_ = ::mkdtemp(path_.data()) != nullptr;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (made_) fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  bool made() const { return made_; }
  std::string at(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
  bool made_ = false;
};

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Starts gnuplot in its own process group, so that Ctrl-C does not reach it. Returns 0 or an errno.
int start(pid_t& child, const TemporaryFolder& folder) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  const std::string messages = folder.at("messages"), directory = folder.at("");
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addchdir_np(&actions, directory.c_str());
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  // -d: ignore the user's start-up file
  std::array<std::string, 3> arguments = {"gnuplot", "-d", "script"};
  std::array<char*, 4> argv = {arguments[0].data(), arguments[1].data(), arguments[2].data(), nullptr};
  const int error = ::posix_spawnp(&child, "gnuplot", &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return error;
}

/// The exit status; -1 after killing the process at the timeout.
int wait_for(pid_t child) {
  constexpr int kTimeout = 20'000, kPause = 1000;  // [ms], [us]
  int status = 0;
  for (int waited = 0; waited < kTimeout; ++waited) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) return -1;
    ::usleep(kPause);
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, &status, 0);
  return -1;
}

}  // namespace

std::map<std::string, std::string> gnuplot(const std::string& script, const std::vector<std::string>& names,
                                           std::string& why) {
  const TemporaryFolder folder;
  if (!folder.made() || !(std::ofstream(folder.at("script"), std::ios::binary) << script).flush()) {
    why = "no temporary folder can be written";
    return {};
  }
  pid_t child = 0;
  if (const int error = start(child, folder); error != 0) {
    why = error == ENOENT ? "gnuplot is not installed (Debian: gnuplot-nox)"
                          : std::string("gnuplot cannot be started: ") + std::strerror(error);
    return {};
  }
  std::map<std::string, std::string> out;
  if (wait_for(child) == 0)
    for (const std::string& name : names)
      if (std::string file = content(folder.at(name)); !file.empty()) out[name] = std::move(file);
  if (out.size() == names.size()) return out;
  const std::string messages = content(folder.at("messages")), newline = "\n";
  const auto begin = messages.find_first_not_of(newline);
  why = "gnuplot failed";
  if (begin == std::string::npos)
    for (const std::string& name : names)
      if (!out.contains(name)) why += ": it left no " + name;
  if (begin != std::string::npos) why += ": " + shown(messages.substr(begin, messages.find('\n', begin) - begin));
  return {};
}

std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (const char c : shown(text)) out += c == '\'' || c == '`' ? "''" : std::string(1, c);  // a backquote: a command
  return out + "'";
}

}  // namespace ukemi::tools
