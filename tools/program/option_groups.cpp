#include "tools/program/option_groups.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <string>

namespace ukemi::tools {

namespace {

struct OptionGroup {
  const char* heading;
  std::set<std::string> names;
};

/// In the order of --help; names without dashes.
const std::array<OptionGroup, 9>& option_groups() {
  static const std::array<OptionGroup, 9> groups = {{
      {"What to plan for",
       {"objective", "robust", "share", "scatter", "inflate", "drops", "samples", "penalty", "forbid",
        "respect-ratings", "inexact", "vary", "pareto", "motor-speed", "motor-torque", "ask"}},
      {"What to propose",
       {"next", "heights", "peak", "width", "angle", "hits", "criterion", "directions", "duration", "noise", "tau-max",
        "check"}},
      {"The robot and its drop",
       {"actuator", "nominal", "identified", "scene", "set", "height", "speed", "pitch-deg", "drop-from", "normal",
        "contacts", "lock", "base", "pin-height"}},
      {"The motion",
       {"motion", "hold", "bumps", "landing-gains", "release-phi", "release-rate", "release-from", "slice", "rate"}},
      {"The logs",
       {"rig", "robot", "trials", "columns", "pieces", "tie", "module", "hebi-effort", "multi-turn", "force-log",
        "force-columns", "force-clock", "trial-rig", "drive", "log", "motion-of", "height-of", "speed-of",
        "start-angle"}},
      {"The fit",
       {"free", "per-run", "nuisance", "prior", "errors", "start", "starts", "lower", "upper", "validate", "law",
        "strict", "diagnose", "profile"}},
      {"The search", {"solver", "solvers", "evaluations", "deadline", "tolerance", "evidence", "seed", "grid"}},
      {"The files",
       {"output", "json", "details", "quiet", "no-report", "figures", "export", "joint", "open", "shard", "merge",
        "with"}},
      {"Expert",
       {"accuracy", "threads", "speed-max", "motor-torque-max", "force-noise", "force-curve", "loss", "weights",
        "polish", "repetitions", "seeds", "times"}},
  }};
  return groups;
}

/// Prints headings in the order above; CLI11 does so in the order of the options.
class GroupFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return make_expanded(app);
    std::string out = make_description(app) + make_usage(app, name) + make_positionals(app) + section(*app, "Options");
    for (const OptionGroup& g : option_groups()) out += section(*app, g.heading);
    return out + make_subcommands(app, mode) + "\n" + make_footer(app);
  }

 private:
  std::string section(const CLI::App& app, const std::string& heading) const {
    const auto options =
        app.get_options([&](const CLI::Option* o) { return o->get_group() == heading && o->nonpositional(); });
    return options.empty() ? "" : make_group(heading, false, options);
  }
};

void group(CLI::App& verb, const std::shared_ptr<GroupFormatter>& formatter) {
  verb.formatter(formatter);
  for (CLI::Option* option : verb.get_options())
    for (const OptionGroup& g : option_groups())
      if (!option->get_lnames().empty() && g.names.count(option->get_lnames().front())) option->group(g.heading);
  for (CLI::App* subcommand : verb.get_subcommands({})) group(*subcommand, formatter);
}

}  // namespace

void group_options(CLI::App& app) { group(app, std::make_shared<GroupFormatter>()); }

}  // namespace ukemi::tools
