// ukemi compare: identified against nominal parameters.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "identify/rig/rig.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/report/report.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr const char* kSets[2] = {"nominal", "identified"};

struct ParameterRow {
  std::string name, unit;
  double nominal, identified, percent;
  std::optional<double> std, z;
  std::optional<bool> inside;
};

std::vector<ParameterRow> parameter_rows(const Actuator& nominal, const Actuator& identified) {
  std::vector<ParameterRow> rows;
  const auto a = constants(nominal.sea), b = constants(identified.sea);
  constexpr double kHalfWidth = 1.959963984540054;
  for (std::size_t i = 0; i < kConstants; ++i) {
    ParameterRow r{kConstantNames[i], kConstantUnits[i], a[i], b[i], 100 * (b[i] - a[i]) / a[i], {}, {}, {}};
    r.std = identified.standard_error(kConstantNames[i]);
    if (r.std && *r.std > 0) {
      r.z = (b[i] - a[i]) / *r.std;
      r.inside = std::abs(*r.z) <= kHalfWidth;
    }
    rows.push_back(r);
  }
  return rows;
}

}  // namespace

int run_compare(const CompareArguments& a, const CommonOptions& common, Json* out) {
  Run run("compare", common);
  const Actuator sets[2] = {actuator_of(a.nominal, run), actuator_of(a.identified, run)};
  if (a.trials.empty() != a.rig.empty()) throw InputError("compare: --trials and --rig belong together");
  std::optional<Scene> scene;
  if (!a.scene.empty()) scene = read_scene(a.scene), run.input(a.scene);
  identify::Rig rig{};
  std::vector<identify::Trial> trials;
  Json summary;
  if (!a.trials.empty()) {
    rig = identify::read_rig(a.rig);
    run.input(a.rig);
    TrialInputs inputs = read_trials(a.trials, a.reading, rig, {}, run);
    trials = std::move(inputs.trials);
    summary = std::move(inputs.summary);
  }
  Report report("Identified against nominal");
  report.paragraph("nominal: " + sets[0].name + "; identified: " + sets[1].name);

  // The constants.
  CsvWriter csv = run.csv();
  csv.comment(
      "z: difference in standard errors of the identified constant; inside_ci95: the nominal value inside its 95 % "
      "interval.");
  csv.header(
      {"parameter", "unit", "nominal", "identified", "difference", "difference_percent", "std", "z", "inside_ci95"});
  std::vector<std::vector<std::string>> table;
  for (const ParameterRow& r : parameter_rows(sets[0], sets[1])) {
    csv.cell(r.name).cell(r.unit).cell(r.nominal).cell(r.identified).cell(r.identified - r.nominal).cell(r.percent);
    csv.cell(r.std.value_or(NAN)).cell(r.z.value_or(NAN)).cell(r.inside ? (*r.inside ? "true" : "false") : "");
    csv.end_row();
    Json& j = summary["parameters"][r.name];
    j = {{"nominal", r.nominal},
         {"identified", r.identified},
         {"difference", r.identified - r.nominal},
         {"difference_percent", number(r.percent)},
         {"std", number(r.std)},
         {"z", number(r.z)}};
    j["inside_ci95"] = r.inside ? Json(*r.inside) : Json(nullptr);
    table.push_back({r.name, fmt::format("{:.5g}", r.nominal), fmt::format("{:.5g}", r.identified),
                     fmt::format("{:+.1f} %", r.percent), r.z ? fmt::format("{:+.1f}", *r.z) : "-",
                     r.inside ? (*r.inside ? "yes" : "no") : "-"});
    run.say(fmt::format("{:8} nominal {:<8.5g} identified {:<8.5g} {:>+8.1f} %  {}", r.name, r.nominal, r.identified,
                        r.percent, r.z ? fmt::format("{:+.1f} standard errors", *r.z) : ""));
  }
  run.add("parameters.csv", csv.text());
  report.heading("Constants");
  report.table(
      {"constant", "nominal", "identified", "difference", "in standard errors", "nominal inside the 95 % interval"},
      table);

  // Both sets on the trials.
  bool failed = false;
  if (!a.trials.empty()) {
    identify::Fit fits[2];
    identify::FitOptions options;
    options.escape = escape_of(a.reading);
    for (int s = 0; s < 2; ++s) {
      SeaParameters<double> sea = sets[s].sea;
      sea.tau_max = rig.tau_max.value_or(sea.tau_max);
      sea.feedback = rig.feedback.value_or(sea.feedback);
      fits[s] = identify::predict(rig, trials, sea, options);
      if (!fits[s].converged) run.warn(std::string(kSets[s]) + ": " + fits[s].message), failed = true;
    }
    summary["residuals"] = Json::array();
    table.clear();
    const auto rms = [](const identify::TrialResult& t) {
      return t.status == identify::RolloutStatus::kDone ? t.rms : NAN;
    };
    for (std::size_t m = 0; m < trials.size(); ++m) {
      const double n = rms(fits[0].trials[m]), i = rms(fits[1].trials[m]);
      summary["residuals"].push_back({{"file", trials[m].file}, {"nominal", number(n)}, {"identified", number(i)}});
      table.push_back({trials[m].file, fmt::format("{:.4g}", n), fmt::format("{:.4g}", i)});
    }
    run.say(fmt::format("residual rms over {} trials: nominal {:.4g} rad, identified {:.4g} rad", trials.size(),
                        fits[0].rms, fits[1].rms));
    report.heading("Residuals on the trials, rms [rad]");
    report.table({"trial", "nominal", "identified"}, table);
  }

  // Each one's best motion, and each motion under the other actuator.
  if (scene) {
    OptimizeOptions options;
    options.seed = common.seed, options.threads = common.threads;
    Optimum best[2];
    for (int s = 0; s < 2; ++s) {
      options.monitor = run.monitor(fmt::format("optimize, {}", kSets[s]));
      best[s] = s == 1 && a.identified_best ? *a.identified_best : optimize(*scene, sets[s].sea, options);
      if (!best[s].found) {
        run.warn(std::string(kSets[s]) + ": " + best[s].message);
        return run.finish(summary, kNumbers);
      }
      if (!best[s].message.empty()) run.warn(std::string(kSets[s]) + ": " + best[s].message);
      summary["motions"][kSets[s]] = motion_json(best[s].motion);
      summary["tolerant_peaks"][kSets[s]] = best[s].tolerant.complete ? number(best[s].tolerant.value) : Json();
      if (options.monitor.stopped()) return run.finish(summary, kNumbers);
    }
    const SimulateOptions tight{.accuracy = options.accuracy, .over = &options.monitor.stop};
    Landing landings[2][2];  // [motion][actuator]
    table.clear();
    for (int m = 0; m < 2; ++m) {
      table.push_back(
          {fmt::format("best for {}: {:.2f} to {:.2f} deg, {:.4f} s", kSets[m], best[m].motion.phi_i * kDegrees,
                       best[m].motion.phi_f * kDegrees, best[m].motion.duration)});
      Json& peaks = summary["peaks"][std::string(kSets[m]) + "_motion"];
      for (int s = 0; s < 2; ++s) {
        landings[m][s] = simulate(*scene, sets[s].sea, best[m].motion, tight, 1000);
        if (no_landing(landings[m][s].end)) run.warn(failure(landings[m][s])), failed = true;
        if (landings[m][s].end == End::kStopped) return run.finish(summary, kNumbers);
        peaks[kSets[s]] = number(landings[m][s].peak);
        table.back().push_back(fmt::format("{:.5g}", landings[m][s].peak));
      }
      run.say(fmt::format(
          "motion best for {:10} ({:.2f}, {:.2f} deg, {:.4f} s): peak {:.5g} with nominal, {:.5g} with identified",
          kSets[m], best[m].motion.phi_i * kDegrees, best[m].motion.phi_f * kDegrees, best[m].motion.duration,
          landings[m][0].peak, landings[m][1].peak));
    }
    report.heading("Peak |ddr_0| [m/s²] on " + scene->name);
    if (!scene->floor_source.empty()) report.paragraph("Floor constants: " + scene->floor_source + ".");
    report.table({"motion", "nominal actuator", "identified actuator"}, table);
    std::vector<Series> series;
    CsvWriter both = run.csv();
    both.comment("Each set's best motion under its own actuator. t = 0 at release. Units: s, m/s^2, rad.");
    both.header({"set", "t", "acc", "phi_1", "phi_ref"});
    for (int s = 0; s < 2; ++s) {
      series.push_back({kSets[s], {}, {}});
      for (const Sample& x : landings[s][s].trajectory) {
        series.back().x.push_back(x.t), series.back().y.push_back(x.acc);
        both.cell(kSets[s]).cell(x.t).cell(x.acc).cell(x.phi1).cell(x.phi_ref).end_row();
      }
    }
    run.add("trajectories.csv", both.text());
    report.plot("t [s] after release", "|ddr_0| [m/s²], each best motion under its own actuator", series);
  }
  report.list(run.warnings());
  run.add("report.html", report.html(run.provenance()));
  if (out) *out = summary;
  return run.finish(summary, failed ? kNumbers : kDone);
}

void add_compare(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<CompareArguments>();
  auto common = std::make_shared<CommonOptions>();
  CLI::App* verb =
      app.add_subcommand("compare", "identified against nominal parameters: constants, residuals, best motions");
  verb->add_option("--nominal", args->nominal, "actuator file (TOML)")->required();
  verb->add_option("--identified", args->identified, "actuator file (TOML), with its covariance where there is one")
      ->required();
  verb->add_option("--scene", args->scene, "scene file: best motions, each under both actuators");
  verb->add_option("--trials", args->trials, "trial files: residuals of both sets");
  verb->add_option("--rig", args->rig, "rig file, with --trials");
  add_trial_options(*verb, args->reading);
  add_common(*verb, *common);
  verb->footer("Example: ukemi compare --nominal nominal.toml --identified actuator.toml --scene scene.toml -o out");
  verb->callback([args, common, &chosen] { chosen = [args, common] { return run_compare(*args, *common); }; });
}

}  // namespace ukemi::tools
