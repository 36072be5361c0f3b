#include "landing/model/motion.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/csv.hpp"

namespace ukemi::landing {

namespace {

/// 15/8 |b - a| / t, at the middle of a quintic [rad/s].
double quintic_rate(double a, double b, double duration) { return a == b ? 0 : 1.875 * std::abs(b - a) / duration; }

/// Largest rate of a piece with bumps: the largest sample, refined by the parabola through it and its neighbours.
double shaped_rate(const ReferencePiece<double>& piece) {
  constexpr int kParts = 64;
  const double h = piece.duration / kParts;
  const auto rate = [&](double t) { return std::abs(piece.at(piece.start + t, true).dphi); };
  double best = 0, at = 0;
  for (int i = 1; i < kParts; ++i)
    if (const double r = rate(i * h); r > best) best = r, at = i * h;
  const double left = rate(at - h), right = rate(at + h), bend = left - 2 * best + right;
  if (bend < 0) best = std::max(best, rate(at + 0.5 * h * (left - right) / bend));
  return best;
}

}  // namespace

void validate(const Motion& m) {
  check_finite("phi_i", m.phi_i), check_finite("phi_f", m.phi_f);
  check_positive("duration", m.duration);
  for (const double b : m.bumps) check_finite("bumps", b);
  check_not_negative("gain_p", m.gain_p), check_not_negative("gain_d", m.gain_d);
  if (!m.reposition) return;
  const Reposition& r = *m.reposition;
  check_finite("reposition.phi", r.phi), check_finite("reposition.rate", r.rate);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (r.from == kNever && r.to == kNever) return;
  check_not_negative("reposition.from", r.from);
  if (!(r.to > r.from && r.to < kNever))
    throw InputError("reposition.to: " + shortest(r.to) + " s: later than `from`, at " + shortest(r.from) +
                     " s, is needed");
}

bool moves_in_air(const Motion& m, double start) {
  return m.reposition && start > m.reposition->from && std::isfinite(start);
}

Reference<double> reference_before(const Motion& m, double time) {
  if (!m.reposition || time >= m.reposition->to) return {m.phi_i, 0};
  if (time <= m.reposition->from) return {m.reposition->phi, 0};
  return reposition_of(m).at(time, false);
}
Motion started_at(const Motion& m, double time) {
  Motion out = m;
  out.phi_i = reference_before(m, time).phi;
  return out;
}

Reference<double> reference_of(const Motion& m, double time) {
  if (time <= 0) return {m.phi_i, 0};
  if (time >= m.duration) return {m.phi_f, 0};
  return landing_of(m, m.phi_i, 0.0).at(time, has_bumps(m));
}

double peak_reference_rate(const Motion& m, double start) {
  const Motion played = started_at(m, start);
  const double landing = has_bumps(m) ? shaped_rate(landing_of(played, played.phi_i, 0.0))
                                      : quintic_rate(played.phi_i, m.phi_f, m.duration);
  const auto& r = m.reposition;
  return r ? std::max(landing, quintic_rate(r->phi, m.phi_i, r->to - r->from)) : landing;
}

}  // namespace ukemi::landing
