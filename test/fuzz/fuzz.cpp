// libFuzzer's entry: $UKEMI_FUZZ names the reader; without it the command line, where that is built in.
#include <cstdio>
#include <cstdlib>

#include "test/fuzz/targets.hpp"

namespace {

fuzz::Target chosen() {
#ifdef UKEMI_FUZZ_COMMAND
  return fuzz::command_line;
#else
  const char* name = std::getenv("UKEMI_FUZZ");
  const auto found = fuzz::readers().find(name ? name : "");
  if (found != fuzz::readers().end()) return found->second;
  std::fprintf(stderr, "UKEMI_FUZZ: one of");
  for (const auto& [known, target] : fuzz::readers()) std::fprintf(stderr, " %s", known.c_str());
  std::fprintf(stderr, " is needed\n");
  std::exit(2);
#endif
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Target target = chosen();
  target({reinterpret_cast<const char*>(data), size});
  return 0;
}
