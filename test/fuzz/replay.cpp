// Plays the corpus: replay CORPUS. Each folder of it is a target's, each file an input that was once found or shows the
// way.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "test/fuzz/targets.hpp"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  if (argc != 2) return 2;
  auto targets = fuzz::readers();
  targets["command"] = fuzz::command_line;
  int failed = 0;
  for (const auto& [name, target] : targets) {
    int played = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(argv[1]) / name)) {
      std::ifstream in(entry.path(), std::ios::binary);
      try {
        target({std::istreambuf_iterator<char>(in), {}});
      } catch (const std::exception& e) {
        std::printf("%s: %s\n", entry.path().c_str(), e.what());
        ++failed;
      }
      ++played;
    }
    std::printf("%s: %d inputs\n", name.c_str(), played);
    if (played < 2) ++failed;
  }
  return failed == 0 ? 0 : 1;
}
