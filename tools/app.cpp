#include "tools/app.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "common/error.hpp"
#include "common/files.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/manual.hpp"
#include "tools/program/option_groups.hpp"
#include "tools/program/terminal.hpp"
#include "tools/program/verb.hpp"

namespace ukemi::tools {

namespace {

/// What a package is made with; --help does not name it.
void add_manual(CLI::App& app, Action& chosen) {
  auto folder = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("manual", "bash completion and the list of man pages")->group("");
  verb->add_option("DIR", *folder, "folder for both")->required();
  verb->callback([&app, &chosen, folder] {
    chosen = [files = manual(app), folder] {
      require_writable_folder(*folder);
      for (const auto& [name, text] : files) write_file(*folder + "/" + name, text);
      return int(kDone);
    };
  });
}

/// Refuses values that are not decimal numbers, empty values, and options without the option that they need.
void check_values(CLI::App& app) {
  constexpr std::pair<const char*, const char*> kNeeds[] = {{"--joint", "--export"}, {"--force-clock", "--force-log"}};
  for (CLI::App* verb : app.get_subcommands({})) {
    check_values(*verb);
    for (const auto& [option, needed] : kNeeds)
      if (CLI::Option* const o = verb->get_option_no_throw(option); o && verb->get_option_no_throw(needed))
        o->needs(verb->get_option(needed));
    for (CLI::Option* option : verb->get_options()) {
      if (option->get_items_expected_max() > 0)
        option->check(CLI::Validator(
            [](const std::string& text) { return std::string(text.empty() ? "a value is needed, not ''" : ""); }, ""));
      const std::string type = option->get_type_name();
      const bool whole = type.starts_with("INT") || type.starts_with("UINT");
      if (whole || type.starts_with("FLOAT"))
        option->check(CLI::Validator(
            [whole](const std::string& text) { return number_fault(text, whole ? Whole::kYes : Whole::kNo); }, ""));
    }
  }
}

/// Throws InputError on a verb or an option that there is not, with the nearest one.
void check_words(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* verb = &app;
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    std::vector<std::string> known;
    if (word == "--") return;
    if (word.starts_with("--")) {
      for (const CLI::Option* option : verb->get_options())
        for (const std::string& n : option->get_lnames()) known.push_back("--" + n);
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw InputError(fmt::format("{}: no such option of {}{}", quoted(name), verb->get_name(), hint(name, known)));
      continue;
    }
    const auto verbs = verb->get_subcommands([](const CLI::App*) { return true; });
    const auto at = std::find_if(verbs.begin(), verbs.end(), [&](auto* v) { return v->get_name() == word; });
    for (const CLI::App* v : verbs)
      if (!v->get_group().empty()) known.push_back(v->get_name());
    if (at != verbs.end())
      verb = *at;
    else if (verb == &app && !word.starts_with('-'))
      throw InputError(quoted(word) + ": no such verb" + hint(word, known));
  }
}

}  // namespace

void add_verbs(CLI::App& app, Action& chosen) {
  app.set_version_flag("--version", "ukemi " UKEMI_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done; 1 the numbers did not work out, or memory or stdout gave out; 2 bad usage or bad input; 130 "
      "interrupted (Ctrl-C).");
  for (const Verb& verb : verbs())
    verb.add(app.add_subcommand(verb.name, verb.purpose)->group(name(verb.group)), chosen);
  add_manual(app, chosen);
  check_values(app);
  group_options(app);
}

/// The message of a command that CLI11 refuses.
std::string message_of(const CLI::ParseError& e) {
  const std::string text = e.what();
  const std::size_t counts = text.find(": At Most 1 required");
  return counts == std::string::npos ? text : text.substr(0, counts) + ": given more than once";
}

Action action_of(int argc, const char* const* argv) {
  CLI::App app("ukemi: identify a series elastic actuator, plan the landing it should make", "ukemi");
  Action chosen;
  add_verbs(app, chosen);
  try {
    std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == "help")
      std::rotate(words.begin(), words.begin() + 1, words.end()), words.back() = "--help";
    check_words(app, words);
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app.parse(std::move(words));
    return chosen;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) throw InputError(message_of(e));
    std::ostringstream out, err;  // --help, --version
    const int code = app.exit(e, out, err);
    return [text = out.str(), code] { return print_raw(text), code; };
  }
}

}  // namespace ukemi::tools
