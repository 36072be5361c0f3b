// The program's two streams. A message never ends the program; a result that did not get through is reported at the
// end.
#pragma once

#include <optional>
#include <string>

namespace ukemi::tools {

/// At the start of the program: a stream that is closed is opened on nothing, so that no file of ours takes its number;
/// a broken pipe and a file that grows beyond its limit are errors, no longer signals.
void prepare_streams();

/// A line of the result on stdout, made safe to show.
void print_line(const std::string& line);
/// What is made for programs, to stdout as it is.
void print_raw(const std::string& text);
/// The system's reason where stdout has not taken all of it.
std::optional<std::string> stdout_failure();

/// Opens a file with what the desktop opens it with; false where there is no xdg-open. Does not wait for it.
bool open_for_reader(const std::string& file);

/// The colour of a message where stderr is a terminal that knows colours and NO_COLOR is not set
/// (https://no-color.org): a warning in yellow, an error in bold red. The words say it too.
enum class Tone { kPlain, kWarning, kError };
/// A line on stderr, made safe to show; where stderr takes none it is lost.
void print_message(const std::string& line, Tone tone = Tone::kPlain);
/// To stderr as it is; takes no memory.
void print_message_raw(const char* text);

}  // namespace ukemi::tools
