#include "tools/program/manual.hpp"

#include <fmt/format.h>

#include <functional>
#include <vector>

namespace ukemi::tools {

namespace {

/// What --help names.
std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}
std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  return app.get_options([&](const CLI::Option* o) { return o->get_positional() == positional; });
}
/// The command line that calls it: "ukemi bench scenes".
std::string words_of(const CLI::App& app) {
  return app.get_parent() ? words_of(*app.get_parent()) + " " + app.get_name() : app.get_name();
}
std::string page_of(const CLI::App& app) {
  return app.get_parent() ? page_of(*app.get_parent()) + "-" + app.get_name() : app.get_name();
}

/// Text for troff: nothing in it is a command.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += std::string("\\&") + c;
    else
      out += c;
  }
  return out;
}

std::string option_lines(const CLI::App& app, bool positional) {
  std::string out;
  for (const CLI::Option* o : options_of(app, positional)) {
    const std::string type = o->get_expected_max() == 0 ? "" : o->get_type_name();  // none: a flag
    out += fmt::format(".TP\n\\fB{}\\fR{}\n{}{}\n", troff(o->get_name(positional, !positional)),
                       type.empty() || positional ? "" : " \\fI" + troff(type) + "\\fR", troff(o->get_description()),
                       o->get_required() ? " (needed)" : "");
  }
  return out;
}

std::string man_page(const CLI::App& app, const std::string& version) {
  const std::string page = page_of(app);
  std::string synopsis = fmt::format("\\fB{}\\fR [\\fIOPTIONS\\fR]", troff(words_of(app)));
  for (const CLI::Option* o : options_of(app, true)) synopsis += " \\fI" + troff(o->get_name(true)) + "\\fR";
  const auto verbs = verbs_of(app);
  if (!verbs.empty()) synopsis += " \\fIVERB\\fR ...";
  std::string out = fmt::format(".TH {} 1 \"\" \"{}\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}\n", page, version,
                                troff(page), troff(app.get_description()), synopsis);
  if (const std::string lines = option_lines(app, true); !lines.empty()) out += ".SH ARGUMENTS\n" + lines;
  out += ".SH OPTIONS\n" + option_lines(app, false);
  if (!verbs.empty()) out += ".SH VERBS\n";
  for (const CLI::App* verb : verbs)
    out += fmt::format(".TP\n\\fB{}\\fR\n{}\n", troff(verb->get_name()), troff(verb->get_description()));
  if (!app.get_footer().empty()) out += ".SH NOTES\n" + troff(app.get_footer()) + "\n";
  std::string see;
  if (app.get_parent()) see = page_of(*app.get_parent());
  for (const CLI::App* verb : verbs) see += (see.empty() ? "" : ", ") + page_of(*verb);
  return out + ".SH SEE ALSO\n" + troff(see) + "\n";
}

/// A line of the completion's two tables for the program or a verb, and for those below it.
void add_words(const CLI::App& app, std::string& known, std::string& lines) {
  std::string words;
  for (const CLI::App* verb : verbs_of(app)) words += verb->get_name() + " ";
  for (const CLI::Option* o : options_of(app, false))
    for (const std::string& name : o->get_lnames()) words += "--" + name + " ";
  lines += fmt::format("    '{}') words='{}' ;;\n", words_of(app), words);
  for (const CLI::App* verb : verbs_of(app)) {
    known += fmt::format("{}'{}'", known.empty() ? "" : "|", words_of(*verb));
    add_words(*verb, known, lines);
  }
}

std::string completion(const CLI::App& app) {
  std::string known, lines;
  add_words(app, known, lines);
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
                     name, known, lines);
}

}  // namespace

std::map<std::string, std::string> manual(const CLI::App& app, const std::string& version) {
  std::map<std::string, std::string> out{{app.get_name() + ".bash", completion(app)}};
  const std::function<void(const CLI::App&)> add = [&](const CLI::App& a) {
    out[page_of(a) + ".1"] = man_page(a, version);
    for (const CLI::App* verb : verbs_of(a)) add(*verb);
  };
  add(app);
  return out;
}

}  // namespace ukemi::tools
