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

/// The base, then the struct's own fields kFields; a missing field is a compile error.
template <class T, class Base, auto... kFields>
struct WithBase {
  static_assert(field_count<T>() == 1 + sizeof...(kFields), "a field of it is not named");
  template <class A, class X>
  static void apply(A& a, X& x) {
    if constexpr (A::kReading)
      serialize(a, static_cast<Base&>(x));
    else
      serialize(a, static_cast<const Base&>(x));
    (serialize(a, x.*kFields), ...);
  }
};
/// All fields; the run times kTimes are not compared.
template <class T, auto... kTimes>
struct ExceptTimes {
  template <class A, class X>
  static void apply(A& a, X& x) {
    for_each_field(x, [&](auto& field) {
      const auto is_time = [&field](const double& time) { return static_cast<const void*>(&time) == &field; };
      if (!a.compares() || !(is_time(x.*kTimes) || ...)) serialize(a, field);
    });
  }
};
template <>
struct Serializer<landing::Progress> : ExceptTimes<landing::Progress, &landing::Progress::seconds> {};
template <>
struct Serializer<landing::Optimum> : ExceptTimes<landing::Optimum, &landing::Optimum::seconds> {};
template <>
struct Serializer<landing::Answer> : ExceptTimes<landing::Answer, &landing::Answer::evidence_seconds> {};
template <>
struct Serializer<landing::BodyProgress> : ExceptTimes<landing::BodyProgress, &landing::BodyProgress::seconds> {};
template <>
struct Serializer<landing::BodyPlan> : ExceptTimes<landing::BodyPlan, &landing::BodyPlan::seconds> {};
template <>
struct Serializer<landing::MappedPeaks> : ExceptTimes<landing::MappedPeaks, &landing::MappedPeaks::map_seconds> {};
using landing::BodyLanding, landing::BodyRisk, landing::Landing, landing::PeakRisk, landing::Risk, landing::RunEnd;
template <>
struct Serializer<Landing> : WithBase<Landing, RunEnd, &Landing::touches, &Landing::peaks, &Landing::trajectory,
                                      &Landing::demands, &Landing::energy_residual> {};
template <>
struct Serializer<BodyLanding>
    : WithBase<BodyLanding, RunEnd, &BodyLanding::broken, &BodyLanding::loads, &BodyLanding::touches,
               &BodyLanding::peaks, &BodyLanding::demands, &BodyLanding::trajectory, &BodyLanding::energy_residual,
               &BodyLanding::base, &BodyLanding::speed, &BodyLanding::theta> {};
template <>
struct Serializer<Risk> : WithBase<Risk, PeakRisk, &Risk::worst> {};
template <>
struct Serializer<BodyRisk> : WithBase<BodyRisk, PeakRisk, &BodyRisk::scatter, &BodyRisk::assumed, &BodyRisk::worst> {};
template <>
struct Serializer<landing::Survey>
    : WithBase<landing::Survey, landing::MappedPeaks, &landing::Survey::scene, &landing::Survey::basins> {};
template <>
struct Serializer<landing::BodySurvey>
    : WithBase<landing::BodySurvey, landing::MappedPeaks, &landing::BodySurvey::scene, &landing::BodySurvey::minima,
               &landing::BodySurvey::basins> {};
using identify::Estimates, identify::Fit, tools::Calibration;
template <>
struct Serializer<Fit> : WithBase<Fit, Estimates, &Fit::sea, &Fit::rms, &Fit::identifiable, &Fit::far_above_noise,
                                  &Fit::flawed_logs, &Fit::interrupted, &Fit::minima, &Fit::trials, &Fit::sensitivity> {
};
using tools::FloorFit;
template <>
struct Serializer<FloorFit>
    : WithBase<FloorFit, Estimates, &FloorFit::logs_of, &FloorFit::tests, &FloorFit::channels, &FloorFit::noise,
               &FloorFit::rms, &FloorFit::drops, &FloorFit::bands, &FloorFit::profiles, &FloorFit::steps> {};
template <>
struct Serializer<Calibration> : WithBase<Calibration, FloorFit, &Calibration::scene> {};
template <>
struct Serializer<tools::BodyCalibration>
    : WithBase<tools::BodyCalibration, FloorFit, &tools::BodyCalibration::scene, &tools::BodyCalibration::laws,
               &tools::BodyCalibration::best_law, &tools::BodyCalibration::scene_law> {};
template <>
struct Serializer<tools::RobotFit> : WithBase<tools::RobotFit, FloorFit, &tools::RobotFit::robot> {};

/// Which terms of a table are fitted; the table itself is constant.
template <class T>
struct Serializer<identify::Terms<T>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    if constexpr (A::kReading) {
      if constexpr (std::is_same_v<T, identify::RigTerm>)
        x = identify::rig_choice();
      else
        x = tools::drop_choice();
      serialize(a, static_cast<identify::Choice&>(x));
    } else {
      serialize(a, static_cast<const identify::Choice&>(x));
    }
  }
};
/// A term: its Term fields; the others come from the table, by its name.
template <>
struct Serializer<identify::RigTerm> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    if constexpr (A::kReading) {
      identify::Term plain;
      serialize(a, plain);
      for (const identify::RigTerm& t : identify::rig_terms())
        if (t.name == plain.name) x = t;
      static_cast<identify::Term&>(x) = std::move(plain);
    } else {
      serialize(a, static_cast<const identify::Term&>(x));
    }
  }
};
/// String literals of the libraries; those that are read are kept for the life of the process.
template <>
struct Serializer<const char*> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    std::string text = x ? x : "";
    serialize(a, text);
    if constexpr (A::kReading) {
      static std::set<std::string> literals;
      x = literals.insert(text).first->c_str();
    }
  }
};
template <>
struct Serializer<landing::MotionValues> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    landing::Coordinates values = x;
    serialize(a, values);
    if constexpr (A::kReading) x = values;
  }
};
/// Compared by its accessors, as its bytes have padding.
template <>
struct Serializer<landing::ContactOrder> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    static_assert(std::is_trivially_copyable_v<landing::ContactOrder>);
    if (!a.compares()) {
      std::array<char, sizeof x> bytes;
      if constexpr (!A::kReading) std::memcpy(bytes.data(), &x, sizeof x);
      serialize(a, bytes);
      if constexpr (A::kReading) std::memcpy(static_cast<void*>(&x), bytes.data(), sizeof x);
      return;
    }
    if constexpr (!A::kReading) {
      a.number(x.size()), a.number(x.first());
      for (int i = 0; i < x.size(); ++i) a.number(x[i]);
      for (int p = 0; p < x.kMaxPoints; ++p) a.number(x.touched(p));
    }
  }
};
/// The drops of a search under scatter are not serialised: a search draws them anew.
template <>
struct Serializer<std::shared_ptr<const landing::Robust>> {
  template <class A, class X>
  static void apply(A&, X&) {}
};

}  // namespace ukemi::python
