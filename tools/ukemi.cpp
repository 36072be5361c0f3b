// The program `ukemi`: see tools/docs or `ukemi --help`.
#include <unistd.h>

#include <exception>
#include <new>
#include <stdexcept>

#include "common/error.hpp"
#include "tools/app.hpp"
#include "tools/program/terminal.hpp"

namespace ukemi::tools {

namespace {

constexpr const char* kNoMemory = "ukemi: not enough memory\n";

/// Every exception is a line on stderr and an exit code.
int guarded(int argc, char** argv) {
  try {
    set_command_line(argc, argv);
    return action_of(argc, argv)();
  } catch (const InputError& e) {
    print_message(std::string("ukemi: ") + e.what(), Tone::kError);
    return kBadInput;
  } catch (const std::bad_alloc&) {
    print_message_raw(kNoMemory);
  } catch (const std::length_error&) {  // more than a container can ever hold
    print_message_raw(kNoMemory);
  } catch (const std::exception& e) {
    print_message(std::string("ukemi: ") + e.what(), Tone::kError);
  }
  return kNumbers;
}

/// For an exception that no one may catch: out of memory where nothing may be thrown is no bug of the program.
[[noreturn]] void end_without_memory() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    print_message_raw(kNoMemory);
    ::_exit(kNumbers);
  } catch (...) {
  }
  std::abort();
}

/// Takes the stack that a verb needs while there is memory: where its growth meets a limit later, a signal would end
/// the program without a word.
[[gnu::noinline]] void take_stack() {
  constexpr std::size_t kNeeded = 1 << 20, kPage = 4096;  // [bytes]
  char room[kNeeded];
  for (std::size_t i = kNeeded; i >= kPage; i -= kPage) *const_cast<volatile char*>(room + i - kPage) = 0;
}

/// The exit code, which is no success where stdout did not take the results.
int final_code(int code) {
  const auto failure = stdout_failure();
  if (!failure) return code;
  print_message("ukemi: stdout cannot be written: " + *failure, Tone::kError);
  return code == kDone ? kNumbers : code;
}

}  // namespace
}  // namespace ukemi::tools

int main(int argc, char** argv) {
  using namespace ukemi::tools;
  std::set_terminate(end_without_memory);
  take_stack();
  prepare_streams();
  return final_code(guarded(argc, argv));
}
