#include "landing/model/player.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"

namespace ukemi::landing {

Player::Player(std::vector<Motion> motions) : motions_(std::move(motions)), landings_(motions_) {
  if (motions_.empty()) throw InputError("player: a motion for each joint is needed");
  for (const Motion& m : motions_) validate(m);
}

bool Player::released(double t) noexcept {
  if (!std::isfinite(t)) return false;
  released_ = t, touchdown_.reset();
  return true;
}

bool Player::touchdown(double t) noexcept {
  if (!std::isfinite(t) || touchdown_ || !released_ || t < *released_) return false;
  touchdown_ = t;
  for (std::size_t i = 0; i < motions_.size(); ++i) landings_[i] = started_at(motions_[i], t - *released_);
  return true;
}

DriveCommand Player::at(int joint, double t) const noexcept {
  const auto i = std::size_t(std::clamp(joint, 0, joints() - 1));
  const Motion& m = motions_[i];
  if (touchdown_ && t >= *touchdown_) {
    const Reference<double> r = reference_of(landings_[i], t - *touchdown_);
    return {r.phi, r.dphi, m.gain_p, m.gain_d};
  }
  if (!released_ || !(t > *released_)) return {m.release_phi(), 0};
  const Reference<double> r = reference_before(m, t - *released_);
  return {r.phi, r.dphi};
}

double Player::end() const noexcept {
  if (!touchdown_) return std::numeric_limits<double>::infinity();
  const auto longest =
      std::max_element(motions_.begin(), motions_.end(), [](auto& a, auto& b) { return a.duration < b.duration; });
  return *touchdown_ + longest->duration;
}

}  // namespace ukemi::landing
