// A landing with SUNDIALS CVODE: Adams with fixed-point iteration, or BDF with Newton iteration and a dense Jacobian by
// difference quotients; events by its root finding.
#pragma once

#include <cvode/cvode.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <stdexcept>

#include "test/bench/cvode_kernels.hpp"
#include "test/bench/peer.hpp"

namespace ukemi::bench {

/// Solver memory made once and used for every landing.
class CvodeLanding {
 public:
  enum class Kind { kAdams, kBdf };

  explicit CvodeLanding(Kind kind) {
    check(SUNContext_Create(nullptr, &context_));
    y_ = N_VMake_Serial(kSize, state_.data(), context_);
    sample_ = N_VMake_Serial(kSize, inside_.data(), context_);
    units_ = N_VNew_Serial(kSize, context_);
    for (N_Vector v : {y_, sample_, units_}) fit_to_size(*v->ops);
    memory_ = CVodeCreate(kind == Kind::kAdams ? CV_ADAMS : CV_BDF, context_);
    state_.setZero();
    check(CVodeInit(memory_, field, 0, y_));
    check(CVodeSStolerances(memory_, 1e-6, 1e-6));
    check(CVodeSetUserData(memory_, this));
    check(CVodeSetErrHandlerFn(
        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr));
    check(CVodeSetMaxStep(memory_, kMaxStep));
    check(CVodeRootInit(memory_, System::kGuards, guard_values));
    std::array<int, System::kGuards> falling;
    falling.fill(-1);
    check(CVodeSetRootDirection(memory_, falling.data()));
    check(CVodeSetNoInactiveRootWarn(memory_));
    // Chosen by trial on these landings: the step is kept only where it could grow by less than a tenth or a fifth (by
    // default, a half), and Adams iterates with one vector of Anderson's acceleration, twice as exactly. Both targets
    // cost less than with the defaults. The first step after an event is the library's own choice: it starts again with
    // order 1, and a share of the last step made no difference. The field is a twentieth of the time of BDF, so an
    // analytic Jacobian would change little.
    check(CVodeSetEtaFixedStepBounds(memory_, 0, kind == Kind::kAdams ? 1.1 : 1.2));
    if (kind == Kind::kAdams) {
      iteration_ = SUNNonlinSol_FixedPoint(y_, 1, context_);
      check(CVodeSetNonlinearSolver(memory_, iteration_));
      check(CVodeSetNonlinConvCoef(memory_, 0.05));
    } else {
      matrix_ = SUNDenseMatrix(kSize, kSize, context_);
      linear_ = SUNLinSol_Dense(y_, matrix_, context_);
      fit_to_size(*matrix_->ops);
      fit_to_size(*linear_->ops);
      check(CVodeSetLinearSolver(memory_, linear_, matrix_));
    }
  }
  ~CvodeLanding() {
    CVodeFree(&memory_);
    if (iteration_) SUNNonlinSolFree(iteration_);
    if (linear_) SUNLinSolFree(linear_);
    if (matrix_) SUNMatDestroy(matrix_);
    for (N_Vector v : {y_, sample_, units_}) N_VDestroy(v);
    SUNContext_Free(&context_);
  }
  CvodeLanding(const CvodeLanding&) = delete;
  CvodeLanding& operator=(const CvodeLanding&) = delete;

  Result operator()(const Case& c, double accuracy) {
    Course course(c);
    system_ = &course.system;
    calls_ = 0;
    for (int i = 0; i < kSize; ++i) NV_Ith_S(units_, i) = accuracy * system_->tolerance_unit(i);
    check(CVodeSVtolerances(memory_, accuracy, units_));
    const bool failed = !(course.settle(-1) && run(course));
    course.result.derivatives += calls_;
    return course.finish(failed);
  }

 private:
  static constexpr int kSize = System::kStates;
  static_assert(kSize == kVectorSize);

  SUNContext context_ = nullptr;
  State state_, inside_, slope_;
  N_Vector y_ = nullptr, sample_ = nullptr, units_ = nullptr;
  void* memory_ = nullptr;
  SUNNonlinearSolver iteration_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver linear_ = nullptr;
  const System* system_ = nullptr;
  long calls_ = 0;

  static void check(int flag) {
    if (flag != 0) throw std::runtime_error("CVODE: flag " + std::to_string(flag));
  }

  static int field(double t, N_Vector y, N_Vector dy, void* data) {
    auto& self = *static_cast<CvodeLanding*>(data);
    ++self.calls_;
    values(dy) = self.system_->derivative(t, State(values(y)));
    return 0;
  }
  static int guard_values(double t, N_Vector y, double* out, void* data) {
    Guards g;
    static_cast<CvodeLanding*>(data)->system_->guards(t, State(values(y)), State(State::Zero()),
                                                      g);  // only the values are used
    std::copy(g.value.begin(), g.value.end(), out);
    return 0;
  }

  /// State (order 0) or slope (1) of the step's polynomial.
  const State& polynomial(double t, int order) {
    CVodeGetDky(memory_, t, order, sample_);
    return inside_;
  }

  void restart(const Course& course) {
    state_ = course.y;
    check(CVodeReInit(memory_, course.t, y_));
    check(CVodeSetStopTime(memory_, course.stop()));
  }

  bool run(Course& course) {
    const System& system = course.system;
    Guards end;
    double q0 = course.square();
    restart(course);
    for (long n = 0; n < kMaxSteps; ++n) {
      double t1;
      const int flag = CVode(memory_, course.t + 1, y_, &t1, CV_ONE_STEP);
      if (flag < 0) return false;
      const double t0 = course.t;
      double h = t1 - t0;
      slope_ = polynomial(t1, 1);  // close to the field, which costs more
      system.guards(t1, state_, slope_, end);
      // CVODE sees the guards at the step's ends only: look inside too.
      int event = -1;
      Guards seen = end;
      if (flag == CV_ROOT_RETURN) {
        std::array<int, System::kGuards> found;
        CVodeGetRootInfo(memory_, found.data());
        for (int i = System::kGuards - 1; i >= 0; --i)
          if (found[i] < 0) event = i;
        if (event >= 0) seen.value[event] = 1e-300;
      }
      const Crossing missed = first_crossing(course.start, seen, h, [&](double s, Guards& g) {
        system.guards(t0 + s * h, polynomial(t0 + s * h, 0), slope_, g);
      });
      if (missed.guard >= 0) {
        event = missed.guard, h *= missed.s;
        state_ = polynomial(t0 + h, 0);
        slope_ = polynomial(t0 + h, 1);
      }

      // The field itself is evaluated only where the polynomial's slope shows a value near the running peak.
      double q1 = course.square(state_, slope_);
      if (q1 > 0.8 * course.peak.square) {
        q1 = course.square(state_, system.derivative(t0 + h, state_));
        course.peak.consider(q1, t0 + h);
      }
      search_peak(course.peak, q0, q1, [&](double s) {
        const double t = t0 + s * h;
        const State& inside = polynomial(t, 0);
        const double q = course.square(inside, system.derivative(t, inside));
        course.peak.consider(q, t);
        return q;
      });

      course.t = t0 + h, course.y = state_, course.dy = slope_, course.start = end;
      if (event >= 0 && !course.settle(event)) return false;
      if (event < 0 && flag != CV_TSTOP_RETURN) {
        if (!course.y.allFinite()) return false;
        q0 = q1;
        continue;
      }
      if (course.t >= course.stop() - kSameInstant && course.ended()) return true;
      if (event < 0 && !course.settle(-1)) return false;
      q0 = course.square();
      restart(course);
    }
    return false;
  }
};

}  // namespace ukemi::bench
