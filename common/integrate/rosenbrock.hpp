// Rosenbrock methods: linearly implicit, for stiff phases. One Jacobian and one LU factorisation a step, no iteration.
//
// With W = 1 / (h gamma) - J, J = df/dy, and the transformed stages u_i (Hairer, Wanner, Solving Ordinary Differential
// Equations II, 2nd ed. (1996), IV.7):
//
//     W u_i = f(t + c_i h, y + sum_j a_ij u_j) + sum_j (C_ij / h) u_j + h d_i df/dt,     y_1 = y + sum_j m_j u_j
//
// The Jacobian is exact: the system offers `linearize`, by Jets. Tests: test/convergence/order.cpp.
#pragma once

#include <Eigen/Core>

#include "common/integrate/dense_lu.hpp"
#include "common/integrate/runge_kutta.hpp"

namespace ukemi::integrate {

/// Rodas5P: order 5, L-stable, stiffly accurate (the last stage is the error estimate), dense output of order 4.
/// Source: G. Steinebach, BIT Numer. Math. 63:27 (2023).
struct Rodas5P {
  static constexpr const char* kName = "rodas5p";
  static constexpr int kOrder = 5, kErrorOrder = 4, kDenseOrder = 4, kStages = 8;
  static constexpr double gamma = 0.21193756319429014;
  static constexpr double c[kStages] = {
      0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1, 1, 1};
  static constexpr double d[kStages] = {
      gamma, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0, 0, 0};
  static constexpr double a[kStages][kStages] = {
      {},
      {3.0},
      {2.849394379747939, 0.45842242204463923},
      {-6.954028509809101, 2.489845061869568, -10.358996098473584},
      {2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641},
      {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946},
      {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1},
      {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1, 1},
  };
  static constexpr double coupling[kStages][kStages] = {
      {},
      {-14.155112264123755},
      {-17.97296035885952, -2.859693295451294},
      {147.12150275711716, -1.41221402718213, 71.68940251302358},
      {165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306},
      {24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471},
      {30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
       -28.087943162872662},
      {37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
       -54.66780262877968, -9.48861652309627},
  };
  /// Dense output: y(t + s h) = (1 - s) y + s (y_1 + (1 - s) (D_0 + s (D_1 + s D_2))), D_q = sum_j p[q][j] u_j.
  static constexpr int kDenseTerms = 3;
  static constexpr double p[kDenseTerms][kStages] = {
      {25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
       1.1241088310450404, 0.4272876194431874, -0.17202221070155493},
      {-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
       15.98066361424651, -6.789040303419874, -6.710236069923372},
      {11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
       -59.78993625266729, -0.15582684282751913, 4.883087185713722},
  };
};

/// The stages of a Rosenbrock step, whose ends the caller holds. Components beyond the first kCoupled are integrals:
/// they feed nothing back, and follow from the others without being factorised.
template <class Tableau, int N, int kCoupled>
class RosenbrockStages {
 public:
  using State = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  /// Sets e.y_end and e.slope_end from e.t, e.h, e.y, e.slope.
  template <class Ends, class F>
  void advance(Ends& e, F&& f) {
    if (!(e.t == jacobian_t_ && e.y == jacobian_y_)) {  // kept after a rejected step
      f.linearize(e.t, e.y, jacobian_, rate_);
      jacobian_t_ = e.t, jacobian_y_ = e.y;
    }
    constexpr int n = kCoupled;
    const double h = e.h, pivot = 1 / (h * Tableau::gamma);
    Block w = -jacobian_.template topLeftCorner<n, n>();
    w.diagonal().array() += pivot;
    lu_.compute(w.data(), n);
    State arg;
    for (int i = 0; i < Tableau::kStages; ++i) {
      arg = e.y;
      State rhs = (h * Tableau::d[i]) * rate_;
      for (int j = 0; j < i; ++j) {
        arg += Tableau::a[i][j] * u_[j];
        rhs += (Tableau::coupling[i][j] / h) * u_[j];
      }
      State slope = e.slope;
      if (i > 0) f(e.t + Tableau::c[i] * h, arg, slope);
      rhs += slope;
      u_[i].template head<n>() = rhs.template head<n>();
      lu_.solve(u_[i].data());
      if constexpr (n < N)
        u_[i].template tail<N - n>() =
            (rhs.template tail<N - n>() + jacobian_.template bottomLeftCorner<N - n, n>() * u_[i].template head<n>()) /
            pivot;
    }
    e.y_end = arg + u_[Tableau::kStages - 1];
    f(e.t + h, e.y_end, e.slope_end);
    dense_ready_ = false;
  }

  const State& error() const { return u_[Tableau::kStages - 1]; }

  /// The field has jumped: the Jacobian is evaluated anew, even at the same time and state.
  void invalidate() { jacobian_t_ = std::numeric_limits<double>::quiet_NaN(); }

  /// y at the fraction s of the computed step from y to `end`.
  State at(const State& y, const State& end, double s) const {
    State sum = State::Zero();
    for (int q = Tableau::kDenseTerms - 1; q >= 0; --q) sum = sum * s + dense_[q];
    return (1 - s) * y + s * (end + (1 - s) * sum);
  }
  void prepare_dense() {
    if (dense_ready_) return;
    for (int q = 0; q < Tableau::kDenseTerms; ++q) {
      dense_[q].setZero();
      for (int j = 0; j < Tableau::kStages; ++j) dense_[q] += Tableau::p[q][j] * u_[j];
    }
    dense_ready_ = true;
  }

  /// Estimate of the spectral radius of the last Jacobian, refined by one power iteration a call [1/s].
  double spectral_radius() {
    const Eigen::Matrix<double, kCoupled, 1> v =
        jacobian_.template topLeftCorner<kCoupled, kCoupled>() * direction_.template head<kCoupled>();
    const double norm = v.norm();
    if (norm > 0 && std::isfinite(norm)) direction_.template head<kCoupled>() = v / norm;
    return norm;
  }

 private:
  Matrix jacobian_;
  State rate_, jacobian_y_;
  double jacobian_t_ = std::numeric_limits<double>::quiet_NaN();
  using Block = Eigen::Matrix<double, kCoupled, kCoupled>;
  DenseLu lu_;
  std::array<State, Tableau::kStages> u_;
  std::array<State, Tableau::kDenseTerms> dense_;
  State direction_ = State::Constant(1);
  bool dense_ready_ = false;
};

template <class Tableau, int N, int kCoupled>
class RosenbrockStep : public StepEnds<double, N> {
 public:
  using State = Eigen::Matrix<double, N, 1>;
  static constexpr int error_order() { return Tableau::kErrorOrder; }
  void invalidate() { stages_.invalidate(); }

  template <class F>
  void advance(F&& f) {
    this->compute();
    stages_.advance(*this, f);
  }
  template <int kControlled>
  double error(const Tolerance<kControlled>& tolerance) const {
    return error_size(stages_.error(), this->y, this->y_end, tolerance);
  }
  template <class F>
  void prepare_dense(F&&) {
    stages_.prepare_dense();
  }
  State at(double s) const {
    const auto point = this->point_at(s);
    return this->extrapolated(stages_.at(this->y, this->computed_end(), point.fraction), point.excess);
  }
  double component_at(int index, double s) const { return at(s)[index]; }

 private:
  RosenbrockStages<Tableau, N, kCoupled> stages_;
};

template <int N, int kCoupled>
struct StepOf<Rodas5P, double, N, kCoupled> {
  using type = RosenbrockStep<Rodas5P, N, kCoupled>;
};

}  // namespace ukemi::integrate
