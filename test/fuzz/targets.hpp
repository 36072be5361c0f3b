// What is fuzzed: each reader of files and the command line, on any bytes. Bad bytes must end as InputError, no other
// way.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace fuzz {

/// Called with the bytes; what it throws is a fault, as is a crash, a hang or a leak.
using Target = void (*)(const std::string& bytes);

/// Those that read files, by the name of their folder of the corpus: trial, hebi, drop, drops, toml.
const std::map<std::string, Target>& readers();
/// The words of a command line, a line each; parsed, not run.
void command_line(const std::string& bytes);

}  // namespace fuzz
