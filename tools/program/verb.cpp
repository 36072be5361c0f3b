#include "tools/program/verb.hpp"

#include <algorithm>
#include <tuple>

namespace ukemi::tools {

namespace {
std::vector<Verb>& registry() {
  static std::vector<Verb> all;  // constructed by the first verb that registers
  return all;
}
}  // namespace

const char* name(VerbGroup group) {
  constexpr const char* kNames[] = {"Constants from logs", "Landings", "The program"};
  return kNames[int(group)];
}

Verb::Verb(VerbGroup group_, const char* name_, const char* purpose_, void (*add_)(CLI::App* verb, Action& chosen))
    : group(group_), name(name_), purpose(purpose_), add(add_) {
  registry().push_back(*this);
}

std::vector<Verb> verbs() {
  std::vector<Verb> out = registry();
  std::sort(out.begin(), out.end(), [](const Verb& a, const Verb& b) {
    return std::make_tuple(a.group, std::string(a.name)) < std::make_tuple(b.group, std::string(b.name));
  });
  return out;
}

}  // namespace ukemi::tools
