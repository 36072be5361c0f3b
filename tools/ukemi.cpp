// The program `ukemi`: see tools/docs or `ukemi --help`.
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <new>
#include <sstream>
#include <stdexcept>

#include "common/error.hpp"
#include "tools/bench/bench.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/terminal.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

namespace {

int run(int argc, char** argv) {
  CLI::App app("ukemi: identify a series elastic actuator, plan the landing it should make", "ukemi");
  app.set_version_flag("--version", "ukemi " UKEMI_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done; 1 the numbers did not work out, or memory or stdout gave out; 2 bad usage or bad input; 130 "
      "interrupted (Ctrl-C).");
  set_command_line(argc, argv);
  Action chosen;
  for (const auto add : {add_identify, add_simulate, add_optimize, add_calibrate, add_compare, add_design, add_demo,
                         add_map, add_ratings, add_risk, add_atlas, add_bench})
    add(app, chosen);
  try {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
    if (argc > 1 && argv[1][0] != '-' && std::find(verbs.begin(), verbs.end(), argv[1]) == verbs.end())
      throw InputError(quoted(argv[1]) + ": no such verb" + hint(argv[1], verbs));
    app.parse(argc, argv);
    return chosen();
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) throw InputError(e.what());
    std::ostringstream out, err;  // --help, --version
    const int code = app.exit(e, out, err);
    print_raw(out.str());
    return code;
  }
}

constexpr const char* kNoMemory = "ukemi: not enough memory\n";

/// Every exception is a line on stderr and an exit code.
int guarded(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const InputError& e) {
    tell(std::string("ukemi: ") + e.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    tell_raw(kNoMemory);
  } catch (const std::length_error&) {  // more than a container can ever hold
    tell_raw(kNoMemory);
  } catch (const std::exception& e) {
    tell(std::string("ukemi: ") + e.what());
  }
  return kNumbers;
}

/// For an exception that no one may catch: out of memory where nothing may be thrown is no bug of the program.
[[noreturn]] void end_without_memory() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    tell_raw(kNoMemory);
    ::_exit(kNumbers);
  } catch (...) {
  }
  std::abort();
}

/// The exit code, which is no success where stdout did not take the results.
int final_code(int code) {
  const auto failure = stdout_failure();
  if (!failure) return code;
  tell("ukemi: stdout cannot be written: " + *failure);
  return code == kDone ? kNumbers : code;
}

}  // namespace
}  // namespace ukemi::tools

int main(int argc, char** argv) {
  using namespace ukemi::tools;
  std::set_terminate(end_without_memory);
  prepare_streams();
  return final_code(guarded(argc, argv));
}
