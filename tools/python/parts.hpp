// Serialisation (archive.hpp) of structs that have a base or are no aggregates.
#pragma once

#include <set>

#include "landing/judge/answer.hpp"
#include "landing/judge/survey.hpp"
#include "landing/plan/body_map.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_risk.hpp"
#include "landing/plan/checked_body.hpp"
#include "tools/python/archive.hpp"
#include "tools/study/body_calibration.hpp"
#include "tools/study/calibration.hpp"
#include "tools/study/robot_trials.hpp"

namespace ukemi::python {

/// The base, then the struct's own fields; a missing field is a compile error.
template <class Base, class T, class... Fields>
void serialize_with_base(auto& a, T& x, Fields&... fields) {
  static_assert(field_count<T>() == 1 + sizeof...(Fields), "a field of it is not named");
  serialize(a, static_cast<Base&>(x));
  (serialize(a, fields), ...);
}
/// All fields; the run time is not compared.
void serialize_but_time(auto& a, auto& x, const double& time) {
  for_each_field(x, [&](auto& field) {
    if (!a.compares() || static_cast<const void*>(&time) != &field) serialize(a, field);
  });
}
void serialize(auto& a, landing::Progress& x) { serialize_but_time(a, x, x.seconds); }
void serialize(auto& a, landing::Optimum& x) { serialize_but_time(a, x, x.seconds); }
void serialize(auto& a, landing::Answer& x) { serialize_but_time(a, x, x.evidence_seconds); }
void serialize(auto& a, landing::BodyProgress& x) { serialize_but_time(a, x, x.seconds); }
void serialize(auto& a, landing::BodyPlan& x) { serialize_but_time(a, x, x.seconds); }
void serialize(auto& a, landing::MappedPeaks& x) { serialize_but_time(a, x, x.map_seconds); }
void serialize(auto& a, landing::Landing& x) {
  serialize_with_base<landing::RunEnd>(a, x, x.touches, x.peaks, x.trajectory, x.demands, x.energy_residual);
}
void serialize(auto& a, landing::BodyLanding& x) {
  serialize_with_base<landing::RunEnd>(a, x, x.broken, x.loads, x.touches, x.peaks, x.demands, x.trajectory,
                                       x.energy_residual, x.base, x.speed, x.theta);
}
void serialize(auto& a, landing::Risk& x) { serialize_with_base<landing::PeakRisk>(a, x, x.worst); }
void serialize(auto& a, landing::BodyRisk& x) {
  serialize_with_base<landing::PeakRisk>(a, x, x.scatter, x.assumed, x.worst);
}
void serialize(auto& a, landing::Survey& x) { serialize_with_base<landing::MappedPeaks>(a, x, x.scene, x.basins); }
void serialize(auto& a, landing::BodySurvey& x) {
  serialize_with_base<landing::MappedPeaks>(a, x, x.scene, x.minima, x.basins);
}
void serialize(auto& a, identify::Fit& x) {
  serialize_with_base<identify::Estimates>(a, x, x.sea, x.rms, x.identifiable, x.far_above_noise, x.flawed_logs,
                                           x.interrupted, x.minima, x.trials, x.sensitivity);
}
void serialize(auto& a, tools::FloorFit& x) {
  serialize_with_base<identify::Estimates>(a, x, x.logs_of, x.tests, x.channels, x.noise, x.rms, x.drops, x.bands,
                                           x.profiles, x.steps);
}
void serialize(auto& a, tools::Calibration& x) { serialize_with_base<tools::FloorFit>(a, x, x.scene); }
void serialize(auto& a, tools::BodyCalibration& x) {
  serialize_with_base<tools::FloorFit>(a, x, x.scene, x.laws, x.best_law, x.scene_law);
}
void serialize(auto& a, tools::RobotFit& x) { serialize_with_base<tools::FloorFit>(a, x, x.robot); }

/// Which terms of a table are fitted; the table itself is constant.
template <class A, class T>
void serialize(A& a, identify::Terms<T>& x) {
  if constexpr (A::kReading && std::is_same_v<T, identify::RigTerm>) x = identify::rig_choice();
  if constexpr (A::kReading && !std::is_same_v<T, identify::RigTerm>) x = tools::drop_choice();
  serialize(a, static_cast<identify::Choice&>(x));
}
/// A term: its Term fields; the others come from the table, by its name.
template <class A>
void serialize(A& a, identify::RigTerm& x) {
  identify::Term plain = x;
  serialize(a, plain);
  if constexpr (A::kReading) {
    for (const identify::RigTerm& t : identify::rig_terms())
      if (t.name == plain.name) x = t;
    static_cast<identify::Term&>(x) = std::move(plain);
  }
}
/// String literals of the libraries; those that are read are kept for the life of the process.
template <class A>
void serialize(A& a, const char*& x) {
  std::string text = x ? x : "";
  serialize(a, text);
  if constexpr (A::kReading) {
    static std::set<std::string> literals;
    x = literals.insert(text).first->c_str();
  }
}
void serialize(auto& a, landing::MotionValues& x) { serialize_as<landing::Coordinates>(a, x); }
/// Compared by its accessors, as its bytes have padding.
template <class A>
void serialize(A& a, landing::ContactOrder& x) {
  if (!a.compares()) return a.number(x);
  if constexpr (!A::kReading) {
    a.number(x.size()), a.number(x.first());
    for (int i = 0; i < x.size(); ++i) a.number(x[i]);
    for (int p = 0; p < x.kMaxPoints; ++p) a.number(x.touched(p));
  }
}
/// The drops of a search under scatter are not serialised: a search draws them anew.
void serialize(auto&, std::shared_ptr<const landing::Robust>&) {}

}  // namespace ukemi::python
