#include "tools/report/residuals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/uncertainty.hpp"

namespace ukemi::tools {

using identify::Fit;
using identify::Trial;

namespace {

constexpr std::size_t kColumns = 4, kMaxTrials = 12;

/// phi_sim - phi, empty where one of them is missing.
std::vector<double> residual(const Trial& t, const identify::TrialResult& r) {
  std::vector<double> out;
  for (std::size_t i = 0; i < std::min(t.phi.size(), r.phi.size()); ++i) out.push_back(r.phi[i] - t.phi[i]);
  return out;
}

Panel panel_of(const std::string& title, const std::string& x_label, const std::string& y_label) {
  Panel out;
  out.title = title, out.x_label = x_label, out.y_label = y_label;
  return out;
}

void add(Panel& p, const std::string& name, const std::vector<double>& t, const std::vector<double>& y,
         Series::Style style, int colour) {
  if (!y.empty() && y.size() == t.size()) p.series.push_back({name, t, y, style, colour});
}

std::vector<Panel> force_angle_residual(const Trial& t, const identify::TrialResult& r, std::size_t number,
                                        const identify::JudgedTrial* judged) {
  const std::string file = t.file.substr(t.file.rfind('/') + 1);
  constexpr std::size_t kMaxLetters = 24;
  Panel force = panel_of(fmt::format("{}: {}", number, file.size() > kMaxLetters ? file.substr(0, kMaxLetters) : file),
                         "", "force [N]");
  Panel angle = panel_of("", "", "phi_1 [rad]"), residuals = panel_of("", "t [s]", "residual [mrad]");
  add(force, "", t.t, t.force, Series::Style::kLine, 2);
  if (t.force.empty()) force.y_label = "phi_ref [rad]", add(force, "", t.t, t.phi_ref, Series::Style::kLine, 2);
  add(angle, "", t.t, t.phi, Series::Style::kPoints, 0);
  add(angle, "", t.t, r.phi, Series::Style::kLine, 1);
  const auto add_milli = [&](std::vector<double> values, double factor, Series::Style style, int colour) {
    for (double& x : values) x *= factor * 1e3;
    add(residuals, "", t.t, values, style, colour);
  };
  add_milli(residual(t, r), 1, Series::Style::kLine, 0);
  for (const double side : {-1.0, 1.0})
    if (judged) add_milli(judged->phi, side, Series::Style::kDashed, 1);
  for (Panel* p : {&force, &angle, &residuals}) p->x_range = {{t.t.front(), t.t.back()}};
  return {force, angle, residuals};
}

}  // namespace

double autocorrelation(const std::vector<double>& values, std::size_t lag) {
  if (values.size() <= lag) return std::nan("");
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += (values[i] - mean) * (values[i] - mean);
    if (i + lag < values.size()) products += (values[i] - mean) * (values[i + lag] - mean);
  }
  return products / squares;
}

Figure trials_figure(const std::vector<Trial>& trials, const Fit& fit, const identify::Judgement* judged) {
  Figure out;
  out.name = "trials", out.width = Figure::Width::kWhole, out.panel_height = 150;
  const std::size_t shown = std::min(trials.size(), kMaxTrials);
  out.columns = int(std::min(kColumns, shown));
  for (std::size_t first = 0; first < shown; first += kColumns) {
    std::vector<std::vector<Panel>> columns;
    for (std::size_t m = first; m < std::min(first + kColumns, shown); ++m)
      columns.push_back(force_angle_residual(trials[m], fit.trials[m], m + 1, judged ? &judged->trials[m] : nullptr));
    columns.resize(std::size_t(out.columns));
    for (std::size_t row = 0; row < 3; ++row)
      for (std::vector<Panel>& trial : columns) out.panels.push_back(trial.empty() ? Panel() : trial[row]);
  }
  out.caption = fmt::format(
      "Each trial: what drove it; the angle, measured (points) and predicted (line); the residual (predicted - "
      "measured) on its own scale{}.{} All samples: fit.csv.",
      judged ? ", dashed the 95 % band of the noise and the constants' errors" : "",
      shown < trials.size() ? fmt::format(" The first {} of {}.", shown, trials.size()) : "");
  return out;
}

std::vector<Figure> residual_figures(const std::vector<Trial>& trials, const Fit& fit) {
  constexpr std::size_t kLags = 20;
  std::vector<std::vector<double>> residuals;
  std::vector<double> all;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    residuals.push_back(residual(trials[m], fit.trials[m]));
    all.insert(all.end(), residuals.back().begin(), residuals.back().end());
  }
  std::erase_if(residuals, [](const auto& r) { return r.size() <= kLags; });
  if (residuals.empty()) return {};
  Series correlation{"", {}, {}, Series::Style::kPoints, 0};
  double samples = 0;
  for (const auto& r : residuals) samples += double(r.size());
  for (std::size_t lag = 1; lag <= kLags; ++lag) {
    double sum = 0;
    for (const auto& r : residuals) sum += autocorrelation(r, lag);
    correlation.x.push_back(double(lag)), correlation.y.push_back(sum / double(residuals.size()));
  }
  Figure correlations, histogram;
  correlations.name = "autocorrelation", histogram.name = "residuals";
  Panel p = panel_of("", "lag [samples]", "autocorrelation");
  p.series = {correlation};
  const double band = kNormal975 / std::sqrt(samples);
  p.levels = {{band, "95 % of white noise"}, {-band, ""}};
  p.x_range = {{0, double(kLags) + 1}};
  correlations.panels = {p};
  correlations.caption = "Autocorrelation of the residuals, the mean over the trials: within the band they are white.";
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  constexpr int kBins = 40;
  const double from = *low, width = (*high - *low) / kBins;
  std::vector<double> counts(kBins, 0);
  for (const double r : all)
    if (width > 0) ++counts[std::size_t(std::clamp(int((r - from) / width), 0, kBins - 1))];
  Series outline{"", {1e3 * from}, {0}, Series::Style::kLine, 0};
  for (int b = 0; b < kBins; ++b)
    for (const int edge : {b, b + 1})
      outline.x.push_back(1e3 * (from + edge * width)), outline.y.push_back(counts[std::size_t(b)]);
  outline.x.push_back(1e3 * *high), outline.y.push_back(0);
  Panel h = panel_of("", "residual [mrad]", "samples");
  h.series = {outline};
  histogram.panels = {h};
  histogram.caption = "How the residuals of all trials are distributed.";
  return {correlations, histogram};
}

Figure constants_figure(const std::vector<identify::Estimate>& estimates) {
  Figure out;
  out.name = "constants";
  Panel p = panel_of("", "95 % interval [% of the value]", "");
  Series s{"", {}, {}, Series::Style::kIntervals, 0};
  std::vector<const identify::Estimate*> known;
  for (const identify::Estimate& e : estimates)
    if (e.std && e.value != 0 && std::isfinite(*e.std)) known.push_back(&e);
  for (std::size_t i = 0; i < known.size(); ++i) {
    const identify::Estimate& e = *known[i];
    const auto percent = [&](double x) { return 100 * (x / e.value - 1); };
    p.rows.push_back(e.name);
    s.x.push_back(0), s.y.push_back(double(known.size() - i));
    s.low.push_back(percent(e.ci_low)), s.high.push_back(percent(e.ci_high));
  }
  p.series = {s};
  out.panels = {p}, out.panel_height = 80 + 26.0 * double(known.size());
  out.caption = "How well each constant is known; a constant without an interval is not shown.";
  return out;
}

std::vector<std::string> fit_figures() { return {"constants", "trials", "autocorrelation", "residuals", "trial_#"}; }

}  // namespace ukemi::tools
