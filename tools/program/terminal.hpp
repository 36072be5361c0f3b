// stdout and stderr. A message that cannot be written never ends the program; a result that cannot is reported at the
// end.
#pragma once

#include <optional>
#include <string>

namespace ukemi::tools {

/// Call first: opens closed streams on /dev/null, so that no other file gets their descriptors; makes a broken pipe and
/// a file beyond its size limit errors of the write, not signals.
void prepare_streams();

/// Prints a line of the result to stdout, made safe to show.
void print_line(const std::string& line);
/// Prints text for programs to stdout, unchanged.
void print_raw(const std::string& text);
/// The system's error message, where a write to stdout has failed.
std::optional<std::string> stdout_failure();

/// Opens a file in the desktop's default program, without waiting; false where there is no xdg-open.
bool open_for_reader(const std::string& file);

/// The colour of a message where stderr is a terminal with colours and NO_COLOR is not set
/// (https://no-color.org): a warning in yellow, an error in bold red. The text says it too.
enum class Tone { kPlain, kWarning, kError };
/// Prints a line to stderr, made safe to show; it is lost where the write fails.
void print_message(const std::string& line, Tone tone = Tone::kPlain);
/// Prints to stderr unchanged; allocates nothing.
void print_message_raw(const char* text);

}  // namespace ukemi::tools
