// A verb as a subcommand, and the options that all share.
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

/// An option whose text is one of `choices`; `to` becomes the value of that choice.
template <class T>
void add_choice(CLI::App& verb, const std::string& option, T& to,
                const std::type_identity_t<std::vector<std::pair<std::string, T>>>& choices, const std::string& help) {
  verb.add_option_function<std::string>(
      option, [=, &to](const std::string& text) { to = choice<T>(option, text, choices); }, help);
}

/// Into `given` the names of those of the verb's options so far that the command line has.
void note_given(CLI::App& verb, std::shared_ptr<std::vector<std::string>> given);
/// Throws InputError for one that is not among `known`: beside `beside` it has no say.
void only_known(const std::vector<std::string>& given, const std::vector<std::string>& known,
                const std::string& beside);

/// The common options, the example at the end of the help, and what the verb does when it is chosen.
template <class Arguments>
void add_action(CLI::App& verb, const std::shared_ptr<Arguments>& arguments, const std::string& example, Action& chosen,
                int (*run)(const Arguments&, const CommonOptions&)) {
  auto common = std::make_shared<CommonOptions>();
  add_common(verb, *common);
  verb.footer("Example: " + example);
  verb.callback([=, &chosen] { chosen = [=] { return run(*arguments, *common); }; });
}

}  // namespace ukemi::tools
