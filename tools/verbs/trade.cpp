// ukemi trade.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>

#include "common/error.hpp"
#include "common/files.hpp"
#include "common/text.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/plan/trade_journal.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/trade.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr int kCurvePoints = 9, kMapPoints = 5;  // default number of designs along one axis, and each of two

/// Parses KEY=LO:HI[:N] of an option.
TradeAxis axis_of(const std::string& option, const std::string& text, int default_count, const BodyScene& scene) {
  const Assignment a = assignment(option, text, "KEY=LO:HI[:N]");
  const bool counted = std::count(a.value.begin(), a.value.end(), ':') == 2;
  const NumberRange range = number_range(option, a.value, counted);
  const int n = counted ? range.count : default_count;
  TradeAxis out{a.name, {}};
  for (int i = 0; i < n; ++i) out.values.push_back((range.lower * (n - 1 - i) + range.upper * i) / (n - 1));
  for (const double end : {range.lower, range.upper})  // throws before any search
    try {
      BodyScene tried = scene;
      set_design_number(tried, a.name, end);
    } catch (const InputError& e) {
      throw InputError(option + ": " + e.what());
    }
  return out;
}

std::vector<TradeAxis> axes_of(const TradeArguments& a, const BodyScene& scene) {
  if (a.vary.size() > 2) throw InputError(fmt::format("--vary: {} times: once or twice is needed", a.vary.size()));
  std::vector<TradeAxis> out;
  for (std::size_t i = 0; i < a.vary.size(); ++i) {
    const std::string& option = i < a.vary_options.size() ? a.vary_options[i] : "--vary";
    out.push_back(axis_of(option, a.vary[i], a.vary.size() == 1 ? kCurvePoints : kMapPoints, scene));
    const std::string& name = out.back().name;
    if (out.size() == 2 && out[0].name == name) throw InputError("--vary: " + quoted(name) + ": named twice");
    if (is_rating(name) && a.plan.ratings != OptimizeArguments::Ratings::kRespect)
      throw InputError("--vary: " + quoted(name) + ": --respect-ratings is needed: without it no plan keeps a rating");
  }
  return out;
}

/// Arguments of --pareto: COST,LIMITED[:N].
struct FrontArguments {
  std::string cost, limited;
  std::size_t count = kCurvePoints;
};
FrontArguments front_of(const std::string& text) {
  const std::string option = "--pareto";
  const std::size_t comma = text.find(','), colon = text.rfind(':');
  if (comma == std::string::npos)
    throw InputError(option + ": " + quoted(text) + ": A,B or A,B:N is needed, names of loads");
  FrontArguments out{text.substr(0, comma), text.substr(comma + 1, colon - comma - 1)};
  if (colon == std::string::npos) return out;
  out.count = parsed_number<std::size_t>(text.substr(colon + 1)).value_or(0);
  if (out.count < 2 || out.count > 1000)
    throw InputError(option + ": " + quoted(text) + ": a whole number N of designs from 2 to 1000 is needed");
  return out;
}

TradePart trade_part(const std::string& text, std::size_t designs) {
  const auto [part, parts] = part_of("--shard", text);
  if (part < 1 || part > parts || parts > designs)
    throw InputError(
        fmt::format("--shard: {}: K/N with K from 1 to N is needed, and N up to {}", quoted(text), designs));
  return {part - 1, parts};
}

/// Identity of a trade: a checksum of its inputs and options.
std::string identity_of(const TradeArguments& a, const BodyPlanOptions& search, const Run& run) {
  std::vector<std::string> parts = {UKEMI_VERSION, a.pareto, fmt::format("{}", fmt::join(a.vary, " "))};
  for (const auto& [key, value] : run.provenance())
    if (key.rfind("checksum", 0) == 0) parts.push_back(value);
  const FreedomArguments& f = a.plan.freedom;
  parts.push_back(fmt::format("{} {} {} {} {} {} {} {}", int(search.goal), a.plan.robust.value_or(""),
                              search.share.value_or(0), search.inflate, search.samples, search.evaluations.value_or(0),
                              search.seed, a.plan.ratings == OptimizeArguments::Ratings::kRespect));
  parts.push_back(fmt::format("{} {} {} {}", a.plan.scatter.scatter.value_or(""), f.bumps.value_or(-1),
                              f.gains.value_or(""), fmt::join(a.plan.forbid, ",")));
  constexpr double kAbsent = std::numeric_limits<double>::infinity();
  parts.push_back(fmt::format("{} {} {}", f.release_phi.value_or(kAbsent), f.release_rate.value_or(kAbsent),
                              f.from.value_or(kAbsent)));
  parts.push_back(fmt::format("{}", fmt::join(a.plan.actuators, " ")));
  return checksum(fmt::format("{}", fmt::join(parts, "\n")));
}

/// Reads the journals in the folders of --merge into `out`, whose first `designs` points must then be complete.
void merge(const std::vector<std::string>& folders, const std::string& identity, std::size_t designs,
           const Robot& robot, std::vector<TradePoint>& out) {
  for (const std::string& folder : folders) {
    if (std::error_code ec; !std::filesystem::exists(in(folder, kTradeJournal), ec))
      throw InputError({in(folder, kTradeJournal)},
                       "there is none: a folder of a trade that ran with --shard is needed");
    (void)TradeJournal(in(folder, kTradeJournal), identity, robot.joints.size(), out);
  }
  const auto open = std::count_if(out.begin(), out.begin() + std::ptrdiff_t(designs),
                                  [](auto& p) { return p.plans < TradePoint::kPlans; });
  if (open > 0)
    throw InputError(
        fmt::format("--merge: {} of {} designs are in none of the folders: a shard is missing", open, designs));
}

}  // namespace

int run_trade(const TradeArguments& a, const CommonOptions& common) {
  Run run(kTradeOutputs, common);
  if (a.vary.empty() == a.pareto.empty()) throw InputError("trade: --vary or --pareto is needed, and not both");
  if (!a.merge.empty() && !a.shard.empty()) throw InputError("--merge: --shard has no effect: the parts decide it");
  const BodyScene scene = scene_to_plan(a.plan, run);
  TradeOptions options{.search = plan_options(a.plan, common, scene, run)};
  if (a.plan.ratings == OptimizeArguments::Ratings::kRespect)
    options.prepare = [](BodyScene& s) { (void)respect_ratings(s, "--respect-ratings"); };
  options.monitor = run.monitor("trade", "plans");
  const std::vector<TradeAxis> axes = axes_of(a, scene);
  const std::optional<FrontArguments> front = a.pareto.empty() ? std::nullopt : std::optional(front_of(a.pareto));
  if (front) check_front(scene, front->cost, front->limited, "--pareto");  // before anything is written
  std::size_t designs = front ? front->count : 1;
  for (const TradeAxis& axis : axes) designs *= axis.values.size();

  if (!a.shard.empty()) options.part = trade_part(a.shard, designs);

  TradeResult out{.scene = scene, .search = options.search, .shard = a.shard};
  const std::string identity = identity_of(a, options.search, run);
  options.known = std::vector<TradePoint>(front ? 2 * designs : designs);
  std::optional<TradeJournal> journal;
  if (a.merge.empty()) {
    journal.emplace(in(run.folder(), kTradeJournal), identity, scene.robot.joints.size(), options.known);
    options.done = [&](std::size_t design, const TradePoint& point) { journal->add(design, point); };
  } else {
    merge(a.merge, identity, designs, scene.robot, options.known);
  }
  if (front) {
    Front f = pareto(scene, front->cost, front->limited, front->count, options);
    out.scene = std::move(f.scene), out.trade = std::move(f.trade), out.of = TradeResult::Of::kFront;
  } else {
    out.trade = trade(scene, axes, options);
  }
  if (journal && (interrupted() || !a.shard.empty())) out.journal = journal->bytes();
  return report(out, run);
}

namespace {

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
      ->allow_extra_args(false);
  verb->add_option("--pareto", args->pareto,
                   "A,B[:N], names of loads, or peak: the smallest A for N values that B may have [9]");
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
  verb->add_option("--shard", args->shard, "K/N: only part K of N of the designs");
  verb->add_option("--merge", args->merge,
                   "folders of all shards of a trade with the same options: puts them together");
  add_freedom(*verb, plan.freedom);
  add_action<TradeArguments>(*verb, args, "ukemi trade scene.toml --vary drive.knee.k_sea=20:500:9 -o out", chosen,
                             run_trade);
}

const Verb trade_verb(VerbGroup::kLandings, "trade",
                      "what a number of a robot's design buys: the best landing for each value", add_trade);

}  // namespace

}  // namespace ukemi::tools
