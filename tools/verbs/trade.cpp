// ukemi trade.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/plan/trade.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/trade.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct TradeArguments {
  std::string scene;
  std::vector<std::string> actuators, vary, forbid;
  Goal goal = Goal::kPeak;
  std::optional<std::string> robust;  ///< a measure
  ScatterArguments scatter;
  std::optional<long> evaluations, samples;
  OptimizeArguments::Ratings ratings = OptimizeArguments::Ratings::kReport;
  FreedomArguments freedom;
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
  Run run("trade", common);
  if (!is_body(a.scene))
    throw InputError(
        Location{a.scene},
        "trade: a robot of links is needed, [[robot.link]]; the paper's stands in datasets/robots/paper.toml");
  refuse(!a.scatter.drops.empty(), "--drops");
  BodyScene scene = body_of(a.scene, a.actuators, run);
  apply_freedom(a.freedom, scene);
  forbid(scene, a.forbid, "--forbid");
  constexpr int kCurve = 9, kMap = 5;  // designs along an axis
  std::vector<TradeAxis> axes;
  for (const std::string& text : a.vary) axes.push_back(axis_of(text, a.vary.size() == 1 ? kCurve : kMap, scene));
  if (axes.size() > 2) throw InputError(fmt::format("--vary: {} times: once or twice is needed", axes.size()));
  TradeOptions options;
  BodyPlanOptions& search = options.search;
  search.goal = a.goal, search.evaluations = a.evaluations;
  if (a.robust) search.measure = Measure::parse("--robust", *a.robust);
  if (a.samples) search.samples = *a.samples;
  search.scatter = scatter_of(a.scatter), search.inflate = inflate_of(a.scatter, scene, run);
  search.seed = common.seed, search.threads = common.threads;
  search.validate();
  if (search.scatter) (void)BodyDropModel(scene, *search.scatter);  // refuses what this base has not
  if (a.ratings == OptimizeArguments::Ratings::kRespect)
    options.prepare = [](BodyScene& s) { (void)respect_ratings(s); };
  options.monitor = run.monitor("trade, plans");
  search.monitor.stop = options.monitor.stop;
  return report(scene, trade(scene, axes, options), search, run);
}

}  // namespace

void add_trade(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<TradeArguments>();
  CLI::App* verb =
      app.add_subcommand("trade", "what a number of a robot's design buys: the best landing for each value");
  verb->add_option("SCENE", args->scene, "scene file of a robot of links (TOML)")->required();
  verb->add_option("--actuator", args->actuators, "JOINT=FILE, once for each joint that the robot's file leaves open")
      ->allow_extra_args(false);
  verb->add_option(
          "--vary", args->vary,
          "KEY=LO:HI[:N], once or twice: drive.JOINT.KEY, robot.link.LINK.KEY, robot.contact.CONTACT.KEY (* for "
          "all), floor.KEY, drop.KEY, with the keys and units of the files [N: 9, of two 5 each]")
      ->required()
      ->allow_extra_args(false);
  verb->add_option_function<std::string>(
      "--objective",
      [args](const std::string& s) {
        args->goal = choice<Goal>("--objective", s, {{"peak", Goal::kPeak}, {"tolerant", Goal::kTolerant}});
      },
      "peak, or tolerant: the worst peak within the scene's [execution] tolerance [peak]");
  verb->add_option("--robust", args->robust,
                   "plan for drops that scatter: mean, cvar (the mean of the worst tenth), quantile:Q or worst");
  add_scatter(*verb, args->scatter);
  verb->add_option("--samples", args->samples, "with --robust, drops that are searched on [64]");
  verb->add_option("--evaluations", args->evaluations,
                   "how many motions are tried for each value, with --robust landings [as optimize]");
  verb->add_option("--forbid", args->forbid, "contacts that must never touch")->delimiter(',');
  verb->add_flag_callback(
      "--respect-ratings", [args] { args->ratings = OptimizeArguments::Ratings::kRespect; },
      "keep the references' rates, the motors' speeds and torques within the drives' ratings");
  add_freedom(*verb, args->freedom);
  add_action<TradeArguments>(*verb, args, "ukemi trade scene.toml --vary drive.knee.k_sea=20:500:9 -o out", chosen,
                             run_trade);
}

}  // namespace ukemi::tools
