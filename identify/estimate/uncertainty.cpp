#include "identify/estimate/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/decompositions.hpp"

namespace ukemi::identify {

const char* name(Identifiability v) {
  constexpr const char* kNames[] = {"trusted", "weak", "not identifiable", "at its bound", "fixed", "fitted"};
  return kNames[int(v)];
}

Estimate estimate_of(const Parameter& p, double value, double variance, double half_width, int trial) {
  Estimate e{.name = p.name, .unit = p.unit, .value = value, .std = {}, .trial = trial};
  e.at_bound = value <= p.lower || value >= p.upper;
  set_error(e, variance, variance, half_width);
  return e;
}

void set_error(Estimate& e, double variance, double noise_variance, double half_width) {
  if (!(variance >= 0 && std::isfinite(variance))) return;
  e.std = std::sqrt(variance), e.std_noise = std::sqrt(noise_variance);
  e.ci_low = e.value - half_width * *e.std, e.ci_high = e.value + half_width * *e.std;
}

Identifiability judge(const Estimate& e) {
  if (!e.free) return Identifiability::kFixed;
  if (e.at_bound) return Identifiability::kAtBound;
  if (!e.std) return Identifiability::kNotIdentifiable;
  const double width = e.half_width(), size = e.size();
  return width <= kTrustedWidth * size ? Identifiability::kTrusted
         : width <= kWeakWidth * size  ? Identifiability::kWeak
                                       : Identifiability::kNotIdentifiable;
}

bool all_trusted(const std::vector<Estimate>& parameters) {
  return std::all_of(parameters.begin(), parameters.end(), [](const Estimate& e) {
    return e.verdict == Identifiability::kTrusted || e.verdict == Identifiability::kFixed;
  });
}

void distrust(std::vector<Estimate>& parameters) {
  for (Estimate& e : parameters)
    if (e.verdict == Identifiability::kTrusted) e.verdict = Identifiability::kWeak;
}

std::optional<Weakest> weakest_of(const LeastSquaresSolution& s, const LeastSquaresProblem& problem,
                                  const std::vector<double>& sizes, double variance, double half_width) {
  std::vector<int> constants, others;
  for (int i = 0; i < int(problem.globals.size()); ++i)
    if (!s.at_bound[std::size_t(i)]) (i < int(sizes.size()) ? constants : others).push_back(i);
  // Everything else is eliminated from the information.
  const int n = int(constants.size());
  if (n < 2 || s.information.size() == 0 || !(variance > 0)) return {};
  Eigen::VectorXd size(n);
  for (int i = 0; i < n; ++i) size[i] = sizes[std::size_t(constants[std::size_t(i)])];
  Eigen::MatrixXd m = s.information(constants, constants);
  if (!others.empty()) {
    const Eigen::MatrixXd cross = s.information(constants, others), own = s.information(others, others);
    m -= cross * LeastNorm(own).solve(cross.transpose());
  }
  m = size.asDiagonal() * m * size.asDiagonal();
  if (!m.allFinite()) return {};
  const SymmetricEigen eigen = symmetric_eigen(m);
  const double stiffness = std::max(eigen.values[0], 0.0);  // squares per squared relative change
  const Eigen::VectorXd v = eigen.vectors.col(0);
  // The half width of the 95 % interval along it, at most half of any constant: beyond that nothing is linear.
  const double max_step = 0.5 / v.cwiseAbs().maxCoeff();
  const double step = std::min(half_width * std::sqrt(variance / std::max(stiffness, 1e-300)), max_step);
  Weakest out;
  for (int i = 0; i < n; ++i)
    out.change.emplace_back(problem.globals[std::size_t(constants[std::size_t(i)])].name, step * v[i]);
  std::sort(out.change.begin(), out.change.end(),
            [](const auto& a, const auto& b) { return std::abs(a.second) > std::abs(b.second); });
  if (out.change.front().second < 0)  // either sign is the same direction
    for (auto& [name, change] : out.change) change = -change;
  out.rms = step * std::sqrt(stiffness / double(s.residuals));
  out.noise = std::sqrt(variance);
  return out;
}

std::string in_words(const Weakest& w, const std::string& data, const std::string& outputs, const std::string& unit) {
  constexpr double kNamedShare = 0.25;  // of the largest change
  const double largest = std::abs(w.change.front().second);
  const auto verb = [](double change) { return change > 0 ? "raising " : "lowering "; };
  std::string names, changes;
  std::size_t named = 0;
  while (named < w.change.size() && std::abs(w.change[named].second) >= kNamedShare * largest) ++named;
  for (std::size_t i = 0; i < named; ++i) {
    const auto& [name, change] = w.change[i];
    const char* join = i == 0 ? "" : i + 1 == named ? " and " : ", ";
    const bool same = i > 0 && (change > 0) == (w.change[i - 1].second > 0);
    names += join + name;
    changes += fmt::format("{}{}{} by {:.2g} %", join, same ? "" : verb(change), name, 100 * std::abs(change));
  }
  if (named < w.change.size())
    changes += fmt::format(" (the others by {:.2g} % at most)", 100 * std::abs(w.change[named].second));
  return fmt::format("these {} {} {}: {} changes {} by {:.2g} {} rms, against a noise of {:.2g} {}", data,
                     named > 1 ? "tell least apart" : "say least about", names, changes, outputs, w.rms, unit, w.noise,
                     unit);
}

}  // namespace ukemi::identify
