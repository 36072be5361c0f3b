#include "landing/model/waypoints.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/jet.hpp"

namespace ukemi::landing {

namespace {

bool shaped(const ReferencePiece<double>& p) {
  return std::any_of(p.powers.begin(), p.powers.end(), [](double c) { return c != 0; });
}

/// The reference and its acceleration, `t` from the start of the piece.
Waypoint waypoint(const ReferencePiece<double>& piece, double t) {
  using Jet = ceres::Jet<double, 1>;
  const double within = std::min(t, piece.duration);
  const Reference<Jet> r = piece.cast<Jet>().at(Jet(piece.start) + Jet(within, 0), shaped(piece));
  return {t, r.phi.a, r.dphi.a, r.dphi.v[0]};
}

std::vector<Waypoint> equal_steps(const ReferencePiece<double>& piece, int steps) {
  constexpr double kNanosecond = 1e-9;
  std::vector<Waypoint> out;
  for (int k = 0; k <= steps; ++k)
    out.push_back(waypoint(piece, std::round(piece.duration * k / steps / kNanosecond) * kNanosecond));
  out.back() = {out.back().t, piece.b, 0, 0};
  return out;
}

double spline_error(const ReferencePiece<double>& piece, const std::vector<Waypoint>& points) {
  constexpr int kSamples = 64;
  double worst = 0;
  for (std::size_t k = 1; k < points.size(); ++k)
    for (int i = 1; i < kSamples; ++i) {
      const double t = points[k - 1].t + (points[k].t - points[k - 1].t) * i / kSamples;
      worst = std::max(worst, std::abs(spline_between(points[k - 1], points[k], t) - waypoint(piece, t).phi));
    }
  return worst;
}

}  // namespace

double spline_between(const Waypoint& a, const Waypoint& b, double t) {
  const double h = b.t - a.t, s = (t - a.t) / h;
  const double c1 = a.dphi * h, c2 = 0.5 * a.ddphi * h * h;
  // Contributions of s^3..s^5 at the end to the angle and to its first and second derivative by s.
  const double d0 = b.phi - a.phi - c1 - c2, d1 = b.dphi * h - c1 - 2 * c2, d2 = b.ddphi * h * h - 2 * c2;
  const double c3 = 10 * d0 - 4 * d1 + 0.5 * d2, c4 = -15 * d0 + 7 * d1 - d2, c5 = 6 * d0 - 3 * d1 + 0.5 * d2;
  return a.phi + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))));
}

std::vector<Waypoint> waypoints(const ReferencePiece<double>& piece) {
  constexpr int kMaxSteps = 1000;
  for (int steps = 1;; ++steps) {
    std::vector<Waypoint> points = equal_steps(piece, steps);
    if (!shaped(piece) || steps == kMaxSteps || spline_error(piece, points) <= kSplineMisfit) return points;
  }
}

std::vector<std::vector<Waypoint>> waypoints(const std::vector<ReferencePiece<double>>& pieces) {
  const auto nanoseconds = [](double t) { return std::llround(t * 1e9); };
  std::map<long long, double> times{{0, 0.0}};
  std::vector<std::map<long long, Waypoint>> piece_points;
  for (const ReferencePiece<double>& piece : pieces) {
    piece_points.emplace_back();
    for (Waypoint p : waypoints(piece)) {
      p.t += piece.start;
      piece_points.back().emplace(nanoseconds(p.t), p), times.emplace(nanoseconds(p.t), p.t);
    }
  }
  std::vector<std::vector<Waypoint>> out(pieces.size());
  for (const auto& [key, t] : times)
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const ReferencePiece<double>& piece = pieces[i];
      Waypoint at{t, t < piece.start ? piece.a : piece.b, 0, 0};
      if (const auto found = piece_points[i].find(key); found != piece_points[i].end())
        at = found->second;
      else if (t > piece.start && t < piece.start + piece.duration)
        at = waypoint(piece, t - piece.start), at.t = t;
      out[i].push_back(at);
    }
  return out;
}

}  // namespace ukemi::landing
