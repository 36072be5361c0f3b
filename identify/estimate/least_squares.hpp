// Bounded nonlinear least squares over any rollout: predicted minus measured, exact derivatives, rejected steps,
// covariance.
//
// Parameters are global (shared by every block) or local (a block's own copy of the same list). They are scaled, never
// logged, so that a bound at 0 can be reached. Ceres (trust region, Levenberg-Marquardt) is private to the .cpp.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace ukemi::identify {

struct Parameter {
  std::string name, unit;
  double start;
  double lower, upper;  ///< may be infinite
  double scale;         ///< typical size, > 0: the solver sees value / scale
  bool held = false;    ///< a global that stays at its start
};

/// One block of residuals. `evaluate` fills residuals [size] and, where the pointer is set, the Jacobian [size x
/// (globals + locals)], column by column; it returns false where the model cannot be evaluated (a rejected step).
struct ResidualBlock {
  int size = 0;
  std::function<bool(const double* global, const double* local, double* residuals, double* jacobian)> evaluate;
  std::vector<double> local_start{};  ///< of its own locals, in their units; empty: Parameter::start
};

/// Pulls a global towards a value: the residual (global - value) * weight.
struct PriorResidual {
  int global;
  double value, weight;
};

struct LeastSquaresProblem {
  std::vector<Parameter> globals;
  std::vector<Parameter> locals;  ///< each block has its own copy
  std::vector<ResidualBlock> blocks;
  std::vector<PriorResidual> priors;
  void hold_globals() {  ///< all of them: locals alone are fitted
    for (Parameter& p : globals) p.held = true;
  }
  void validate() const;  ///< throws InputError
};

struct LeastSquaresOptions {
  int max_iterations = 200;
  /// Relative decrease that ends the search: leaves 3e-6 sqrt(residuals) standard errors at most. Ten consecutive steps
  /// of less than three times as much each, on average, end it too: it crawls along an edge of the cost.
  double cost_tolerance = 1e-11;
  double step_tolerance = 1e-11;  ///< relative step that ends it
  double first_radius = 100;      ///< of the trust region; the scaled start is 1: a first step of its own size
  int rejected_steps = 30;        ///< consecutive steps without a model value after which the search fails
  double huber = 0;               ///< Huber's delta on each residual; 0: plain squares
  std::function<bool()>
      stop;  ///< true: end and keep the best point so far, not converged; asked before every trial step
};

struct LeastSquaresSolution {
  Eigen::VectorXd globals;  ///< in the parameters' own units
  Eigen::MatrixXd locals;   ///< blocks x locals
  double cost = 0;          ///< sum of squares (robustified where huber > 0), not half of it
  bool usable = false;      ///< the start could be evaluated and no iterate was lost
  bool converged = false;
  int iterations = 0;
  double work = 0;              ///< spent, in the caller's units; the solver leaves it at 0
  std::string message;          ///< the solver's reason
  std::vector<bool> at_bound;   ///< of the globals; true for held ones too
  long residuals = 0;           ///< n
  Eigen::MatrixXd information;  ///< of the globals, locals eliminated, for unit residual variance; empty where unknown
  Eigen::VectorXd gradient;     ///< of half the cost by the globals; empty where unknown
  /// Inverse of the Fisher information for unit residual variance, over the globals; rows and columns at a bound, and
  /// of what the data do not determine, are NaN. Multiply by the residual variance.
  Eigen::MatrixXd global_covariance;
  Eigen::MatrixXd local_variance;  ///< blocks x locals, the same for each local
  Eigen::VectorXd eigenvalues;     ///< of the scaled information of the free globals, ascending, largest = 1
  long free_parameters = 0;        ///< p
};

/// Minimises the sum of squares within the bounds. A start outside is moved inside.
LeastSquaresSolution solve(const LeastSquaresProblem& problem, const LeastSquaresOptions& options);

/// The sum of squares at a point; infinite where a block cannot be evaluated.
double cost_at(const LeastSquaresProblem& problem, const LeastSquaresOptions& options, const Eigen::VectorXd& globals);

}  // namespace ukemi::identify
