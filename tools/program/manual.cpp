#include "tools/program/manual.hpp"

#include <fmt/format.h>

#include <vector>

namespace ukemi::tools {

namespace {

/// The subcommands that --help lists.
std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}
/// The words that call it: "ukemi bench scenes".
std::string command_path(const CLI::App& app) {
  return app.get_parent() ? command_path(*app.get_parent()) + " " + app.get_name() : app.get_name();
}
/// Appends to the completion's two tables, command paths and words of each, for `app` and its subcommands.
void add_words(const CLI::App& app, std::string& paths, std::string& cases) {
  std::string words;
  for (const CLI::App* verb : verbs_of(app)) words += verb->get_name() + " ";
  for (const CLI::Option* o : app.get_options([](const CLI::Option* o) { return !o->get_positional(); }))
    for (const std::string& name : o->get_lnames()) words += "--" + name + " ";
  cases += fmt::format("    '{}') words='{}' ;;\n", command_path(app), words);
  for (const CLI::App* verb : verbs_of(app)) {
    paths += fmt::format("{}'{}'", paths.empty() ? "" : "|", command_path(*verb));
    add_words(*verb, paths, cases);
  }
}

std::string completion(const CLI::App& app) {
  std::string paths, cases;
  add_words(app, paths, cases);
  const std::string& name = app.get_name();
  return fmt::format(R"(# bash completion for {0}: verbs and options, else files.
_{0}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} path={0} word words
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$path $word" in
      {1}) path="$path $word" ;;
    esac
  done
  case $path in
{2}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  [[ ${{#COMPREPLY[@]}} -gt 0 && ( $words != -* || $current = -* ) ]] || COMPREPLY=($(compgen -f -- "$current"))
}}
complete -o filenames -F _{0} {0}
)",
                     name, paths, cases);
}

/// A line for each man page: its command line and, after a tab, what it does.
std::string pages(const CLI::App& app) {
  std::string out = fmt::format("{}\t{}\n", command_path(app), app.get_description());
  for (const CLI::App* verb : verbs_of(app)) out += pages(*verb);
  return out;
}

}  // namespace

std::map<std::string, std::string> manual(const CLI::App& app) {
  return {{app.get_name() + ".bash", completion(app)}, {"pages", pages(app)}};
}

}  // namespace ukemi::tools
