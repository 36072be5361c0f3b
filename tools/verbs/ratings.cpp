// ukemi ratings.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/judge/speed.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/freedom.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct RatingsArguments {
  std::string scene, speed;
  std::vector<std::string> actuators;
  std::optional<std::string> torque;
  std::optional<long> evaluations;
  FreedomArguments freedom;
};

std::vector<double> grid_of(const std::string& option, const std::string& text) {
  const NumberRange r = number_range(option, text, true);
  if (!(r.lower > 0)) throw InputError(fmt::format("{}: {}: above 0 is needed", option, r.lower));
  std::vector<double> out;
  for (int i = 0; i < r.count; ++i) out.push_back(r.lower + (r.upper - r.lower) * i / (r.count - 1));
  return out;
}

/// ratings of a robot of links: a trade of the ratings of all its drives.
int ratings_of_links(const RatingsArguments& a, const CommonOptions& common) {
  TradeArguments t;
  t.plan.scene = a.scene, t.plan.actuators = a.actuators, t.plan.evaluations = a.evaluations,
  t.plan.freedom = a.freedom;
  t.plan.ratings = OptimizeArguments::Ratings::kRespect;
  const auto vary = [&t](const char* option, const std::string& rating, const std::string& range) {
    (void)grid_of(option, range);
    t.vary.push_back("drive.*." + rating + "=" + range), t.vary_options.push_back(option);
  };
  vary("--motor-speed", "speed_max", a.speed);
  if (a.torque) vary("--motor-torque", "motor_torque_max", *a.torque);
  return run_trade(t, common);
}

int run_ratings(const RatingsArguments& a, const CommonOptions& common) {
  if (is_of_links(a.scene)) return ratings_of_links(a, common);
  Run run(kRatingsOutputs, common);
  const Scene scene = scene_of(a.scene, a.freedom, run);
  const Actuator actuator = landing_actuator_of(only_actuator(a.actuators), run);
  RatingOptions options;
  options.speeds = grid_of("--motor-speed", a.speed);
  if (a.torque)
    options.torques = grid_of("--motor-torque", *a.torque);
  else
    options.torques = {actuator.motor_torque_max.value_or(std::numeric_limits<double>::infinity())};
  if (!a.torque && !actuator.motor_torque_max) warn_of_unknown_ratings(actuator, a.actuators[0], run);
  options.search.evaluations = a.evaluations;
  options.search.seed = common.seed, options.search.threads = common.threads;
  options.search.tolerance_samples = 0;
  options.search.validate();
  options.search.monitor = run.monitor("ratings", "searches");
  return report(scene, rated_plans(scene, actuator, options), run);
}

void add_ratings(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<RatingsArguments>();
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  add_actuators(*verb, args->actuators);
  verb->add_option("--motor-speed", args->speed, "LO:HI:N, rated speeds [rad/s]")->required();
  verb->add_option("--motor-torque", args->torque,
                   "LO:HI:N, rated torques [Nm] [the actuator's motor_torque_max; else no limit]");
  verb->add_option("--evaluations", args->evaluations, "motions tried in each search [40000; tolerant 10000]");
  add_freedom(*verb, args->freedom);
  add_action<RatingsArguments>(*verb, args,
                               "ukemi ratings scene.toml --actuator actuator.toml --motor-speed 2:12:11 -o out", chosen,
                               run_ratings);
}

const Verb ratings_verb(VerbGroup::kLandings, "ratings", "what speed buys: the best peaks against the motor's ratings",
                        add_ratings);

}  // namespace

}  // namespace ukemi::tools
