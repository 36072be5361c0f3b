// ukemi trade.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/plan/trade.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/trade.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct TradeArguments {
  OptimizeArguments plan;  ///< of each design
  std::vector<std::string> vary;
};

/// KEY=LO:HI[:N].
TradeAxis axis_of(const std::string& text, int usual, const BodyScene& scene) {
  const std::string option = "--vary";
  const Assignment a = assignment(option, text);
  const bool counted = std::count(a.value.begin(), a.value.end(), ':') == 2;
  const NumberRange range = number_range(option, a.value, counted);
  const int n = counted ? range.count : usual;
  TradeAxis out{a.name, {}};
  for (int i = 0; i < n; ++i) out.values.push_back((range.lower * (n - 1 - i) + range.upper * i) / (n - 1));
  for (const double end : {range.lower, range.upper})  // refused before anything is searched
    try {
      BodyScene tried = scene;
      set_design_number(tried, a.name, end);
    } catch (const InputError& e) {
      throw InputError(option + ": " + e.what());
    }
  return out;
}

int run_trade(const TradeArguments& a, const CommonOptions& common) {
  Run run(kTradeOutputs, common);
  if (!is_body(a.plan.scene))
    throw InputError(
        Location{a.plan.scene},
        "trade: a robot of links is needed, [[robot.link]]; the paper's stands in datasets/robots/paper.toml");
  const BodyScene scene = scene_to_plan(a.plan, run);
  constexpr int kCurve = 9, kMap = 5;  // designs along an axis
  std::vector<TradeAxis> axes;
  for (const std::string& text : a.vary) axes.push_back(axis_of(text, a.vary.size() == 1 ? kCurve : kMap, scene));
  if (axes.size() > 2) throw InputError(fmt::format("--vary: {} times: once or twice is needed", axes.size()));
  TradeOptions options{.search = plan_options(a.plan, common, scene, run)};
  if (a.plan.ratings == OptimizeArguments::Ratings::kRespect)
    options.prepare = [](BodyScene& s) { (void)respect_ratings(s); };
  options.monitor = run.monitor("trade, plans");
  return report(scene, trade(scene, axes, options), options.search, run);
}

void add_trade(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<TradeArguments>();
  OptimizeArguments& plan = args->plan;
  verb->add_option("SCENE", plan.scene, "scene file of a robot of links (TOML)")->required();
  verb->add_option("--actuator", plan.actuators, "JOINT=FILE, once for each joint that the robot's file leaves open")
      ->allow_extra_args(false);
  verb->add_option(
          "--vary", args->vary,
          "KEY=LO:HI[:N], once or twice: drive.JOINT.KEY, robot.link.LINK.KEY, robot.contact.CONTACT.KEY (* for "
          "all), floor.KEY, drop.KEY, with the keys and units of the files [N: 9, of two 5 each]")
      ->required()
      ->allow_extra_args(false);
  add_objective(*verb, plan.goal);
  verb->add_option("--robust", plan.robust,
                   "plan for drops that scatter: mean, cvar (the mean of the worst tenth), quantile:Q or worst");
  add_scatter(*verb, plan.scatter);
  verb->add_option("--samples", plan.samples, "with --robust, drops that are searched on [64]");
  verb->add_option("--evaluations", plan.evaluations,
                   "how many motions are tried for each value, with --robust landings [as optimize]");
  verb->add_option("--forbid", plan.forbid, "contacts that must never touch")->delimiter(',');
  verb->add_flag_callback(
      "--respect-ratings", [&plan] { plan.ratings = OptimizeArguments::Ratings::kRespect; },
      "keep the references' rates, the motors' speeds and torques within the drives' ratings");
  add_freedom(*verb, plan.freedom);
  add_action<TradeArguments>(*verb, args, "ukemi trade scene.toml --vary drive.knee.k_sea=20:500:9 -o out", chosen,
                             run_trade);
}

const Verb trade_verb(VerbGroup::kLandings, "trade",
                      "what a number of a robot's design buys: the best landing for each value", add_trade);

}  // namespace

}  // namespace ukemi::tools
