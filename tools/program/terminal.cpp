#include "tools/program/terminal.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "common/text.hpp"

namespace ukemi::tools {

namespace {

int stdout_error = 0;  ///< errno of the first failed write

void note_failure(bool failed) {
  if (failed && stdout_error == 0) stdout_error = errno;
}

bool has_colours() {
  const char *no_colour = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) && !(no_colour && *no_colour) && terminal && std::strcmp(terminal, "dumb") != 0;
}

}  // namespace

void prepare_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);  // takes the lowest number; a write to it fails
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void print_raw(const std::string& text) {
  note_failure(std::fwrite(text.data(), 1, text.size(), stdout) != text.size());
}
void print_line(const std::string& line) { print_raw(shown(line) + "\n"); }

std::optional<std::string> stdout_failure() {
  note_failure(std::fflush(stdout) != 0);
  return stdout_error == 0 ? std::nullopt : std::optional<std::string>(std::strerror(stdout_error));
}

bool open_for_reader(const std::string& file) {
  std::array<std::string, 2> words = {"xdg-open", file};
  std::array<char*, 3> argv = {words[0].data(), words[1].data(), nullptr};
  posix_spawn_file_actions_t quiet;
  ::posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, words[0].c_str(), &quiet, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&quiet);
  return error == 0;
}

void print_message_raw(const char* text) { std::fputs(text, stderr); }

void print_message(const std::string& line, Tone tone) {
  static const bool coloured = has_colours();
  const std::string text = shown(line);
  if (tone == Tone::kPlain || !coloured) return print_message_raw((text + "\n").c_str());
  print_message_raw(((tone == Tone::kError ? "\033[1;31m" : "\033[33m") + text + "\033[0m\n").c_str());
}

}  // namespace ukemi::tools
