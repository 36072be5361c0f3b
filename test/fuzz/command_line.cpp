#include <sstream>
#include <vector>

#include "common/error.hpp"
#include "test/fuzz/targets.hpp"
#include "tools/app.hpp"

namespace fuzz {

void command_line(const std::string& bytes) {
  std::vector<std::string> words = {"ukemi"};
  std::istringstream lines(bytes);
  for (std::string word; std::getline(lines, word) && words.size() < 100;) words.push_back(word.c_str());
  std::vector<const char*> argv;
  for (const std::string& w : words) argv.push_back(w.c_str());
  argv.push_back(nullptr);
  try {
    (void)ukemi::tools::action_of(int(words.size()), argv.data());
  } catch (const ukemi::InputError&) {
  }
}

}  // namespace fuzz
