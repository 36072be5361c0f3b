// The local maxima of every load of a landing and their derivatives, beside those of the acceleration that counts.
// Included by gradient_kernel.cpp alone.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "landing/body/load.hpp"
#include "landing/body/load_value.hpp"
#include "landing/derivatives/peak_observer.hpp"

namespace ukemi::landing {

/// What is largest: a load that has its value at every state.
template <class Landing>
class OfLoad {
 public:
  using Jet = typename Landing::Jet;
  OfLoad(const Load& load, const Landing& l) : jet_(load, l.system()), dual_(load, l.dual()) {
    dual_.take_arms(jet_, [](auto& to, const Jet& from) { to = typename Landing::Dual(from.a); });
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

/// The impulse of each touch of a contact: the integral of its force from one moving time to another.
template <class Landing>
class ImpulseObserver {
  using Jet = typename Landing::Jet;
  using Derivatives = typename Landing::Derivatives;
  using State = typename Landing::State;

 public:
  ImpulseObserver(int contact, int most) : contact_(contact), most_(std::size_t(std::max(1, most))) {}
  template <class Driver>
  void step(const Landing& l, Driver& driver) {
    if (!down_) return;
    const auto& step = driver.step();
    for (const auto& [at, weight] : kImpulseNodes) sum_ += Jet(weight * step.h) * force(l, driver.dense().at(at));
  }
  void before(const Landing& l, const State& y, const Derivatives& shift) {
    if (down_) move(l, y, shift);
  }
  void after_event(const Landing& l, double t, const State& y, const Derivatives& shift) {
    const bool touching = l.system().contact[std::size_t(contact_)].touching;
    if (touching && !down_) sum_.setConstant(Jet(0)), down_ = true;
    if (!touching) finish(t);
    if (down_) move(l, y, -shift);
  }
  void finish(double t) {
    if (!down_) return;
    down_ = false;
    using std::sqrt;
    const Jet q = sum_.squaredNorm();
    if (!(q.a > 0)) return;
    const Jet v = sqrt(q);
    keep_largest(peaks, {t, v.a, v.v, PeakKind::kLeftLimit, contact_}, most_);
  }
  bool down() const { return down_; }

  std::vector<PeakGradient<Jet::DIMENSION>> peaks;

 private:
  Vec2<Jet> force(const Landing& l, const State& y) const {
    return contact_force(l.system(), contact_, l.system().pose(y), y);
  }
  /// An end of the integral that moves by `shift`.
  void move(const Landing& l, const State& y, const Derivatives& shift) {
    const Vec2<Jet> f = force(l, y);
    for (int k : {0, 1}) sum_[k].v += f[k].a * shift;
  }

  int contact_;
  std::size_t most_;
  bool down_ = false;
  Vec2<Jet> sum_ = Vec2<Jet>(Jet(0), Jet(0));
};

/// An observer of follow_with_derivatives: of the acceleration that counts and of every load of the scene.
template <class Landing>
class LoadPeaks {
  using Jet = typename Landing::Jet;
  using Derivatives = typename Landing::Derivatives;
  using State = typename Landing::State;
  using Driver = typename Landing::Driver;
  using Values = PeakObserver<Landing, OfLoad<Landing>>;

 public:
  LoadPeaks(const BodyScene& scene, int most) : scene_(scene), most_(most), own(most) {}

  void begin(const Landing& l, double t, const State& y) {
    for (const Load& load : scene_.loads) {
      Item x{&load, {}, {}};
      if (load.kind == Load::Kind::kImpulse)
        x.impulse.emplace(load.index, most_);
      else if (load.kind != Load::Kind::kTouch && !landing::own(load, scene_.robot))
        x.values.emplace(most_, OfLoad<Landing>(load, l));
      items_.push_back(std::move(x));
    }
    own.begin(l, t, y);
    for (Item& x : items_)
      if (x.values) x.values->begin(l, t, y);
  }
  void step(const Landing& l, Driver& driver) {
    own.step(l, driver);
    for (Item& x : items_) {
      if (x.values) x.values->step(l, driver);
      if (x.impulse) x.impulse->step(l, driver);
    }
  }
  void before(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    own.before(l, t, y, dy, shift);
    for (Item& x : items_) {
      if (x.values) x.values->before(l, t, y, dy, shift);
      if (x.impulse) x.impulse->before(l, y, shift);
    }
  }
  void after_event(const Landing& l, double t, const State& y, const Derivatives& shift, int event) {
    own.after_event(l, t, y, shift, event);
    for (Item& x : items_) {
      if (x.values) x.values->after_event(l, t, y, shift, event);
      if (x.impulse) x.impulse->after_event(l, t, y, shift);
    }
  }
  void cut(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    end_ = t;
    own.cut(l, t, y, dy, shift);
    for (Item& x : items_) {
      if (x.values) x.values->cut(l, t, y, dy, shift);
      if (x.impulse) x.impulse->before(l, y, shift);
    }
  }
  void finish(const Landing& l) {
    own.finish(l);
    for (Item& x : items_) {
      if (x.values) x.values->finish(l);
      if (x.impulse) x.impulse->finish(end_);
    }
  }
  /// As LoadObserver::rest_square.
  double running() const {
    RestSquare out(own.running());
    for (const Item& x : items_) {
      if (x.impulse && x.impulse->down()) return -1;
      if (x.values) out.add(x.load->kind, large_square(*x.load, x.values->running()), x.values->last());
    }
    return out.value();
  }
  /// Of a load: the largest values first; of a touch none.
  std::vector<PeakGradient<Jet::DIMENSION>> peaks(std::size_t load) const {
    const Item& x = items_[load];
    if (x.impulse) return x.impulse->peaks;
    if (landing::own(*x.load, scene_.robot)) return own.peaks;
    if (!x.values) return {};
    auto out = x.values->peaks;
    for (auto& p : out) p.value -= half_range(*x.load);
    std::erase_if(out, [](const auto& p) { return p.value <= 0; });
    return out;
  }

 private:
  struct Item {
    const Load* load;
    std::optional<Values> values;
    std::optional<ImpulseObserver<Landing>> impulse;
  };
  const BodyScene& scene_;
  int most_;
  double end_ = 0;
  std::vector<Item> items_;

 public:
  PeakObserver<Landing> own;
};

}  // namespace ukemi::landing
