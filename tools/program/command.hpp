// A verb as a subcommand, and the options that all verbs share.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>

#include "tools/program/arguments.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

using Action = std::function<int()>;  ///< returns the exit code

/// -o, --json, --threads, --seed, --quiet, --no-report.
void add_common(CLI::App& verb, CommonOptions& options);

/// Adds an option whose text is one of `choices`; sets `value` to that of the choice.
template <class T>
void add_choice(CLI::App& verb, const std::string& option, T& value,
                const std::type_identity_t<std::vector<std::pair<std::string, T>>>& choices, const std::string& help) {
  verb.add_option_function<std::string>(
      option, [=, &value](const std::string& text) { value = choice<T>(option, text, choices); }, help);
}

/// At parsing, collects in `given` the names of the options, of those added so far, that the command line has.
void note_given(CLI::App& verb, std::shared_ptr<std::vector<std::string>> given);
/// Throws InputError for a given option that is not among `known`, those that have an effect together with `mode`.
void allow_only(const std::vector<std::string>& given, const std::vector<std::string>& known, const std::string& mode);

/// Adds the common options, the example at the end of the help, and the action that is `chosen` with the verb.
template <class Arguments>
void add_action(CLI::App& verb, const std::shared_ptr<Arguments>& arguments, const std::string& example, Action& chosen,
                int (*run)(const Arguments&, const CommonOptions&)) {
  auto common = std::make_shared<CommonOptions>();
  add_common(verb, *common);
  verb.footer("Example: " + example);
  verb.callback([=, &chosen] { chosen = [=] { return run(*arguments, *common); }; });
}

}  // namespace ukemi::tools
