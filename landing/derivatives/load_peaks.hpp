// The local maxima of the peak acceleration and of every load, with derivatives. Included only by gradient_kernel.cpp.
#pragma once

#include <optional>
#include <vector>

#include "landing/body/load.hpp"
#include "landing/body/load_value.hpp"
#include "landing/derivatives/peak_observer.hpp"

namespace ukemi::landing {

/// A load that is a function of the state, as quantity of PeakObserver.
template <class Landing>
class LoadQuantity {
 public:
  using Jet = typename Landing::Jet;
  LoadQuantity(const Load& load, const Landing& l) : jet_(load, l.system()), dual_(load, l.dual()) {
    dual_.copy_arms(jet_, [](auto& to, const Jet& from) { to = typename Landing::Dual(from.a); });
  }
  Square square(const Landing& l, double t, const typename Landing::Values& y,
                const typename Landing::Values& dy) const {
    const auto q = l.along_motion(
        t, y, dy,
        [&](const auto& s, const auto& time, const auto& x, const auto& dx) { return dual_.square(s, time, x, dx); },
        dual_.load().kind == Load::Kind::kAcceleration);
    return {q.a, q.v[0]};
  }
  Jet magnitude(const Landing& l, double t, const typename Landing::State& y, const typename Landing::State& dy) const {
    using std::sqrt;
    const Jet q = jet_.square(l.system(), t, y, dy);
    return q.a > 0 ? sqrt(q) : Jet(0);
  }

 private:
  LoadValue<typename Landing::System> jet_;
  LoadValue<typename Landing::DualSystem> dual_;
};

/// The impulse of each touch of a contact: the integral of its force, with the derivatives of its moving bounds.
template <class Landing>
class ImpulseObserver {
  using Jet = typename Landing::Jet;
  using Derivatives = typename Landing::Derivatives;
  using State = typename Landing::State;

 public:
  ImpulseObserver(int contact, int max_peaks) : contact_(contact), max_peaks_(std::size_t(std::max(1, max_peaks))) {}
  template <class Driver>
  void step(const Landing& l, Driver& driver) {
    if (!touching_) return;
    const auto& step = driver.step();
    for (const auto& [at, weight] : kImpulseNodes) sum_ += Jet(weight * step.h) * force(l, driver.dense().at(at));
  }
  void before_event(const Landing& l, const State& y, const Derivatives& shift) {
    if (touching_) move_bound(l, y, shift);
  }
  void after_event(const Landing& l, double t, const State& y, const Derivatives& shift) {
    const bool touching = l.system().contact[std::size_t(contact_)].touching;
    if (touching && !touching_) sum_.setConstant(Jet(0)), touching_ = true;
    if (!touching) finish(t);
    if (touching_) move_bound(l, y, -shift);
  }
  void finish(double t) {
    if (!touching_) return;
    touching_ = false;
    using std::sqrt;
    const Jet q = sum_.squaredNorm();
    if (!(q.a > 0)) return;
    const Jet v = sqrt(q);
    keep_largest(peaks, {t, v.a, v.v, PeakKind::kLeftLimit, contact_}, max_peaks_);
  }
  bool touching() const { return touching_; }

  std::vector<PeakGradient<Jet::DIMENSION>> peaks;

 private:
  Vec2<Jet> force(const Landing& l, const State& y) const {
    return contact_force(l.system(), contact_, l.system().pose(y), y);
  }
  /// Adds the derivative of a bound of the integral that moves by `shift`.
  void move_bound(const Landing& l, const State& y, const Derivatives& shift) {
    const Vec2<Jet> f = force(l, y);
    for (int k : {0, 1}) sum_[k].v += f[k].a * shift;
  }

  int contact_;
  std::size_t max_peaks_;
  bool touching_ = false;
  Vec2<Jet> sum_ = Vec2<Jet>(Jet(0), Jet(0));
};

/// An observer of follow_with_derivatives for the peak point's acceleration and every load of the scene.
template <class Landing>
class LoadPeaks {
  using Jet = typename Landing::Jet;
  using Derivatives = typename Landing::Derivatives;
  using State = typename Landing::State;
  using Driver = typename Landing::Driver;
  using Values = PeakObserver<Landing, LoadQuantity<Landing>>;

 public:
  LoadPeaks(const BodyScene& scene, int max_peaks) : scene_(scene), max_peaks_(max_peaks), peak(max_peaks) {}

  void begin(const Landing& l, double t, const State& y) {
    for (const Load& load : scene_.loads) {
      LoadItem x{&load, {}, {}};
      if (load.kind == Load::Kind::kImpulse)
        x.impulse.emplace(load.index, max_peaks_);
      else if (load.kind != Load::Kind::kTouch && !landing::is_peak_acceleration(load, scene_.robot))
        x.values.emplace(max_peaks_, LoadQuantity<Landing>(load, l));
      items_.push_back(std::move(x));
    }
    peak.begin(l, t, y);
    for (LoadItem& x : items_)
      if (x.values) x.values->begin(l, t, y);
  }
  void step(const Landing& l, Driver& driver) {
    peak.step(l, driver);
    for (LoadItem& x : items_) {
      if (x.values) x.values->step(l, driver);
      if (x.impulse) x.impulse->step(l, driver);
    }
  }
  void before_event(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    peak.before_event(l, t, y, dy, shift);
    for (LoadItem& x : items_) {
      if (x.values) x.values->before_event(l, t, y, dy, shift);
      if (x.impulse) x.impulse->before_event(l, y, shift);
    }
  }
  void after_event(const Landing& l, double t, const State& y, const Derivatives& shift, int event) {
    peak.after_event(l, t, y, shift, event);
    for (LoadItem& x : items_) {
      if (x.values) x.values->after_event(l, t, y, shift, event);
      if (x.impulse) x.impulse->after_event(l, t, y, shift);
    }
  }
  void time_limit(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    end_ = t;
    peak.time_limit(l, t, y, dy, shift);
    for (LoadItem& x : items_) {
      if (x.values) x.values->time_limit(l, t, y, dy, shift);
      if (x.impulse) x.impulse->before_event(l, y, shift);
    }
  }
  void finish(const Landing& l) {
    peak.finish(l);
    for (LoadItem& x : items_) {
      if (x.values) x.values->finish(l);
      if (x.impulse) x.impulse->finish(end_);
    }
  }
  /// As LoadObserver::rest_square.
  double running() const {
    RestSquare out(peak.running());
    for (const LoadItem& x : items_) {
      if (x.impulse && x.impulse->touching()) return -1;
      if (x.values) out.add(x.load->kind, reference_square(*x.load, x.values->running()), x.values->last());
    }
    return out.value();
  }
  /// Maxima of a load, the largest first; none for touches.
  std::vector<PeakGradient<Jet::DIMENSION>> peaks(std::size_t load) const {
    const LoadItem& x = items_[load];
    if (x.impulse) return x.impulse->peaks;
    if (landing::is_peak_acceleration(*x.load, scene_.robot)) return peak.peaks;
    if (!x.values) return {};
    auto out = x.values->peaks;
    for (auto& p : out) p.value -= half_range(*x.load);
    std::erase_if(out, [](const auto& p) { return p.value <= 0; });
    return out;
  }

 private:
  struct LoadItem {
    const Load* load;
    std::optional<Values> values;
    std::optional<ImpulseObserver<Landing>> impulse;
  };
  const BodyScene& scene_;
  int max_peaks_;
  double end_ = 0;
  std::vector<LoadItem> items_;

 public:
  PeakObserver<Landing> peak;
};

}  // namespace ukemi::landing
