#include "tools/app.hpp"

#include <algorithm>
#include <sstream>

#include "common/error.hpp"
#include "common/files.hpp"
#include "tools/bench/bench.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/manual.hpp"
#include "tools/program/terminal.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

namespace {

/// What a package is made with; --help does not name it.
void add_manual(CLI::App& app, Action& chosen) {
  auto folder = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("manual", "man pages and bash completion")->group("");
  verb->add_option("DIR", *folder, "folder for the pages and for ukemi.bash")->required();
  verb->callback([&app, &chosen, folder] {
    chosen = [files = manual(app, "ukemi " UKEMI_VERSION), folder] {
      require_writable_folder(*folder);
      for (const auto& [name, text] : files) write_file(*folder + "/" + name, text);
      return int(kDone);
    };
  });
}

}  // namespace

void add_verbs(CLI::App& app, Action& chosen) {
  app.set_version_flag("--version", "ukemi " UKEMI_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done; 1 the numbers did not work out, or memory or stdout gave out; 2 bad usage or bad input; 130 "
      "interrupted (Ctrl-C).");
  for (const auto add : {add_identify, add_simulate, add_optimize, add_calibrate, add_compare, add_design, add_demo,
                         add_map, add_ratings, add_risk, add_atlas, add_bench, add_manual})
    add(app, chosen);
}

Action action_of(int argc, const char* const* argv) {
  CLI::App app("ukemi: identify a series elastic actuator, plan the landing it should make", "ukemi");
  Action chosen;
  add_verbs(app, chosen);
  try {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
    if (argc > 1 && argv[1][0] != '-' && std::find(verbs.begin(), verbs.end(), argv[1]) == verbs.end())
      throw InputError(quoted(argv[1]) + ": no such verb" + hint(argv[1], verbs));
    app.parse(argc, argv);
    return chosen;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) throw InputError(e.what());
    std::ostringstream out, err;  // --help, --version
    const int code = app.exit(e, out, err);
    return [text = out.str(), code] { return print_raw(text), code; };
  }
}

}  // namespace ukemi::tools
