// Structs of the libraries that stand on a base, or are no plain structs, as archive.hpp takes them.
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

/// The base, then the struct's own fields; one that is not named here does not compile.
template <class T, class Base, auto... kFields>
struct OnBase {
  static_assert(field_count<T>() == 1 + sizeof...(kFields), "a field of it is not named");
  template <class A, class X>
  static void go(A& a, X& x) {
    if constexpr (A::kReads)
      carry(a, static_cast<Base&>(x));
    else
      carry(a, static_cast<const Base&>(x));
    (carry(a, x.*kFields), ...);
  }
};
/// All fields; those that say how long something took are not compared.
template <class T, auto... kTimes>
struct ButTimes {
  template <class A, class X>
  static void go(A& a, X& x) {
    for_each_field(x, [&](auto& field) {
      const auto is = [&field](const double& time) { return static_cast<const void*>(&time) == &field; };
      if (!a.compares() || !(is(x.*kTimes) || ...)) carry(a, field);
    });
  }
};
template <>
struct Carry<landing::Progress> : ButTimes<landing::Progress, &landing::Progress::seconds> {};
template <>
struct Carry<landing::Optimum> : ButTimes<landing::Optimum, &landing::Optimum::seconds> {};
template <>
struct Carry<landing::Answer> : ButTimes<landing::Answer, &landing::Answer::evidence_seconds> {};
template <>
struct Carry<landing::BodyProgress> : ButTimes<landing::BodyProgress, &landing::BodyProgress::seconds> {};
template <>
struct Carry<landing::BodyPlan> : ButTimes<landing::BodyPlan, &landing::BodyPlan::seconds> {};
template <>
struct Carry<landing::MappedPeaks> : ButTimes<landing::MappedPeaks, &landing::MappedPeaks::map_seconds> {};
using landing::BodyLanding, landing::BodyRisk, landing::Landing, landing::LandingPeak, landing::PeakRisk, landing::Risk,
    landing::RunEnd;
template <>
struct Carry<LandingPeak> : OnBase<LandingPeak, RunEnd, &LandingPeak::contacts, &LandingPeak::peak_contact,
                                   &LandingPeak::joint_lost, &LandingPeak::state> {};
template <>
struct Carry<Landing> : OnBase<Landing, LandingPeak, &Landing::touches, &Landing::peaks, &Landing::trajectory,
                               &Landing::demands, &Landing::energy_residual> {};
template <>
struct Carry<BodyLanding>
    : OnBase<BodyLanding, RunEnd, &BodyLanding::first_touchdown, &BodyLanding::first_contact, &BodyLanding::broken,
             &BodyLanding::loads, &BodyLanding::touches, &BodyLanding::peaks, &BodyLanding::demands,
             &BodyLanding::trajectory, &BodyLanding::energy_residual, &BodyLanding::base, &BodyLanding::speed> {};
template <>
struct Carry<Risk> : OnBase<Risk, PeakRisk, &Risk::worst> {};
template <>
struct Carry<BodyRisk> : OnBase<BodyRisk, PeakRisk, &BodyRisk::scatter, &BodyRisk::assumed, &BodyRisk::broken> {};
template <>
struct Carry<landing::Survey>
    : OnBase<landing::Survey, landing::MappedPeaks, &landing::Survey::scene, &landing::Survey::basins> {};
template <>
struct Carry<landing::BodySurvey> : OnBase<landing::BodySurvey, landing::MappedPeaks, &landing::BodySurvey::scene,
                                           &landing::BodySurvey::minima, &landing::BodySurvey::basins> {};
using identify::Estimates, identify::Fit, tools::Calibration;
template <>
struct Carry<Fit> : OnBase<Fit, Estimates, &Fit::sea, &Fit::rms, &Fit::identifiable, &Fit::far_above_noise,
                           &Fit::flawed_logs, &Fit::interrupted, &Fit::minima, &Fit::trials, &Fit::sensitivity> {};
using tools::FloorFit;
template <>
struct Carry<FloorFit>
    : OnBase<FloorFit, Estimates, &FloorFit::logs_of, &FloorFit::tests, &FloorFit::channels, &FloorFit::noise,
             &FloorFit::rms, &FloorFit::drops, &FloorFit::promises, &FloorFit::profiles, &FloorFit::steps> {};
template <>
struct Carry<Calibration> : OnBase<Calibration, FloorFit, &Calibration::scene> {};
template <>
struct Carry<tools::BodyCalibration>
    : OnBase<tools::BodyCalibration, FloorFit, &tools::BodyCalibration::scene, &tools::BodyCalibration::laws,
             &tools::BodyCalibration::asked, &tools::BodyCalibration::own> {};
template <>
struct Carry<tools::RobotFit> : OnBase<tools::RobotFit, FloorFit, &tools::RobotFit::robot> {};

/// What is fitted of a table; the table itself is the program's.
template <class T>
struct Carry<identify::Terms<T>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    if constexpr (A::kReads) {
      if constexpr (std::is_same_v<T, identify::RigTerm>)
        x = identify::rig_choice();
      else
        x = tools::drop_choice();
      carry(a, static_cast<identify::Choice&>(x));
    } else {
      carry(a, static_cast<const identify::Choice&>(x));
    }
  }
};
/// A term: its numbers and words, and what the table says of its name beside.
template <>
struct Carry<identify::RigTerm> {
  template <class A, class X>
  static void go(A& a, X& x) {
    if constexpr (A::kReads) {
      identify::Term plain;
      carry(a, plain);
      for (const identify::RigTerm& t : identify::rig_terms())
        if (t.name == plain.name) x = t;
      static_cast<identify::Term&>(x) = std::move(plain);
    } else {
      carry(a, static_cast<const identify::Term&>(x));
    }
  }
};
/// Words of the libraries, which live for ever; so do those that are read.
template <>
struct Carry<const char*> {
  template <class A, class X>
  static void go(A& a, X& x) {
    std::string text = x ? x : "";
    carry(a, text);
    if constexpr (A::kReads) {
      static std::set<std::string> kept;
      x = kept.insert(text).first->c_str();
    }
  }
};
template <>
struct Carry<landing::MotionValues> {
  template <class A, class X>
  static void go(A& a, X& x) {
    landing::Coordinates values = x;
    carry(a, values);
    if constexpr (A::kReads) x = values;
  }
};
/// Compared by what it tells, for its bytes have gaps.
template <>
struct Carry<landing::ContactOrder> {
  template <class A, class X>
  static void go(A& a, X& x) {
    static_assert(std::is_trivially_copyable_v<landing::ContactOrder>);
    if (!a.compares()) {
      std::array<char, sizeof x> bytes;
      if constexpr (!A::kReads) std::memcpy(bytes.data(), &x, sizeof x);
      carry(a, bytes);
      if constexpr (A::kReads) std::memcpy(static_cast<void*>(&x), bytes.data(), sizeof x);
      return;
    }
    if constexpr (!A::kReads) {
      a.number(x.size()), a.number(x.first());
      for (int i = 0; i < x.size(); ++i) a.number(x[i]);
      for (const landing::Point p : {landing::kHip, landing::kKnee, landing::kFoot}) a.number(x.touched(p));
    }
  }
};
/// The drops of a search under scatter are drawn again by whoever searches again: no part of what it found.
template <>
struct Carry<std::shared_ptr<const landing::Robust>> {
  template <class A, class X>
  static void go(A&, X&) {}
};

}  // namespace ukemi::python
