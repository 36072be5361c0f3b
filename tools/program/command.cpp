#include "tools/program/command.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "common/toml.hpp"

namespace ukemi::tools {

void add_common(CLI::App& verb, CommonOptions& o) {
  verb.add_option("-o,--output", o.folder, "folder for the results [./ukemi-out/VERB]")->type_name("DIR");
  verb.add_flag_callback(
      "--json", [&o] { o.out = CommonOptions::Stdout::kJson; }, "stdout carries one JSON object, nothing else");
  verb.add_option("--threads", o.threads, "threads [all cores]; results do not depend on it")
      ->check(CLI::Range(1, 4096));
  verb.add_option_function<std::string>(
          "--seed", [&o](const std::string& text) { o.seed = to_seed("--seed", text); },
          "seed of every random draw [1]")
      ->type_name("N");
  verb.add_flag_callback(
      "--quiet", [&o] { o.messages = CommonOptions::Messages::kQuiet; }, "no messages on stderr but warnings");
  verb.add_flag_callback(
      "--no-report", [&o] { o.report = CommonOptions::Report::kSkip; }, "no report.html");
  verb.add_option_function<std::string>(
          "--figures",
          [&o](const std::string& list) {
            for (const std::string& f : split(list))
              o.figures.push_back(
                  choice<std::string>("--figures", f, {{"svg", "svg"}, {"pdf", "pdf"}, {"png", "png"}}));
          },
          "svg,pdf,png: every figure of the report as a file of its own")
      ->type_name("LIST");
}

void note_given(CLI::App& verb, std::shared_ptr<std::vector<std::string>> given) {
  std::vector<CLI::Option*> options = verb.get_options();
  std::erase_if(options, [](auto* option) { return option->get_positional() || option->check_name("--help"); });
  verb.parse_complete_callback([given, options] {
    for (const CLI::Option* option : options)
      if (option->count() > 0) given->push_back(option->get_name());
  });
}

void allow_only(const std::vector<std::string>& given, const std::vector<std::string>& known, const std::string& mode) {
  for (const std::string& option : given)
    if (std::find(known.begin(), known.end(), option) == known.end())
      throw InputError(option + ": it has no effect with " + mode);
}

}  // namespace ukemi::tools
