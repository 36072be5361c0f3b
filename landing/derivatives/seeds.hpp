// The parameters of landing/derivatives/gradient.hpp as scalars that carry derivatives.
#pragma once

#include <cmath>

#include "common/jet.hpp"
#include "landing/derivatives/gradient.hpp"

namespace ukemi::landing {

/// Seeds P parameters from `first` on with derivatives. Those by constants of the floor and the actuator are relative,
/// so that the error control sees derivatives of similar size.
template <int P>
class Seeds {
 public:
  using Jet = ceres::Jet<double, P>;
  explicit Seeds(Parameter first) : first_(int(first)) {}
  Jet operator()(double x, Parameter which) {
    const int i = int(which) - first_;
    Jet seeded(x);
    if (i < 0 || i >= P) return seeded;
    unit_[i] = which >= Parameter::kStiffness && x != 0 ? std::abs(x) : 1;
    seeded.v[i] = unit_[i];
    return seeded;
  }
  MotionOf<Jet> operator()(const Motion& m) {
    MotionOf<Jet> out{(*this)(m.phi_i, Parameter::kPhiI), (*this)(m.phi_f, Parameter::kPhiF),
                      (*this)(m.duration, Parameter::kDuration)};
    for (std::size_t k = 0; k < kMaxBumps; ++k)
      out.bumps[k] = (*this)(m.bumps[k], Parameter(int(Parameter::kBump0) + int(k)));
    out.gain_p = (*this)(m.gain_p, Parameter::kGainP), out.gain_d = (*this)(m.gain_d, Parameter::kGainD);
    if (const auto& r = m.reposition)
      out.reposition = {Jet(r->phi), Jet(r->rate), Jet(r->from), (*this)(r->to, Parameter::kTo)};
    return out;
  }
  DropOf<Jet> operator()(const Drop& d) {
    return {(*this)(d.height, Parameter::kHeight), (*this)(d.forward_speed, Parameter::kForwardSpeed),
            (*this)(d.pitch, Parameter::kPitch), Jet(d.pitch_rate), Jet(d.vertical_speed)};
  }
  Floor<Jet> operator()(const Floor<double>& f) {
    return {(*this)(f.stiffness, Parameter::kStiffness), (*this)(f.damping_normal, Parameter::kDampingNormal),
            (*this)(f.damping_tangential, Parameter::kDampingTangential)};
  }
  SeaParameters<Jet> operator()(const SeaParameters<double>& sea) {
    SeaParameters<Jet> s = sea.template cast<Jet>();
    s.k_p = (*this)(sea.k_p, Parameter::kKp), s.k_d = (*this)(sea.k_d, Parameter::kKd);
    s.k_sea = (*this)(sea.k_sea, Parameter::kKSea), s.c_sea = (*this)(sea.c_sea, Parameter::kCSea);
    s.i_motor = (*this)(sea.i_motor, Parameter::kIMotor);
    return s;
  }
  /// Scale of each derivative: it is by parameter / unit.
  const Eigen::Array<double, P, 1>& unit() const { return unit_; }

 private:
  int first_;
  Eigen::Array<double, P, 1> unit_ = Eigen::Array<double, P, 1>::Ones();
};

}  // namespace ukemi::landing
