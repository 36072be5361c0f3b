// Named terms: what a fit can estimate. A front end (identify/fit for the rig, tools/study for drops) keeps one table
// of them; the columns of its problem, its bounds, priors, checks and reports follow from the table.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "identify/estimate/choice.hpp"
#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

/// Whether all trials share a term's value, or each has its own.
enum class Scope { kShared, kEach };

/// A term that can be estimated. Front ends derive from it and add how the term enters their model.
struct Term {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  std::string name, unit;
  std::string words = {};  ///< description in reports
  std::string alias = {};  ///< another name that users may give it
  bool is_called(const std::string& given) const { return name == given || (!alias.empty() && alias == given); }
  enum class Role {
    kConstant,  ///< a shared constant of the model, reported whether it is fitted or not
    kNuisance,  ///< fitted where requested, else absent
  } role = Role::kNuisance;
  Scope scope = Scope::kShared;
  double lower = -kInfinity, upper = kInfinity;  ///< bounds where the options name none
  double absent = 0;                             ///< value without effect on the model; a nuisance term starts there
  double size = 1;                               ///< typical size, > 0, where the start is 0
  double smallest_part = 0;  ///< fraction of its size below which the model cannot be evaluated, where its bound is 0
  double judged_size = 0;    ///< least size that its interval is compared with, where its zero is a convention

  bool is_constant() const { return role == Role::kConstant; }
  /// Whether it cannot be below its absence.
  bool one_sided() const { return lower >= absent; }
};

/// All constants of a table free, no nuisance terms.
template <class T>
Terms<T> all_constants(const std::vector<T>& table) {
  Terms<T> out;
  out.table = std::make_shared<const std::vector<T>>(table);
  for (const T& t : table)
    if (t.is_constant()) out.free.push_back(t.name);
  return out;
}

/// Which column of a problem is which term: the constants, then the other shared terms, then those of each trial. The
/// terms must outlive it.
template <class T>
struct Layout {
  std::vector<const T*> shared, own;

  Layout() = default;
  explicit Layout(const Terms<T>& terms) {
    for (const std::string& name : terms.free) shared.push_back(&terms[name]);
    for (const std::string& name : terms.nuisance)
      (terms[name].scope == Scope::kShared ? shared : own).push_back(&terms[name]);
  }
  /// f(term, value, column) for each, at a point of the problem.
  template <class F>
  void for_each(const double* of_shared, const double* of_own, F&& f) const {
    for (std::size_t i = 0; i < shared.size(); ++i) f(*shared[i], of_shared[i], i);
    for (std::size_t i = 0; i < own.size(); ++i) f(*own[i], of_own[i], shared.size() + i);
  }
  static bool holds(const std::vector<const T*>& list, const std::string& name) {
    for (const T* t : list)
      if (t->name == name) return true;
    return false;
  }
};

/// The term as a column that starts at `start` and is scaled by `size`.
Parameter parameter_of(const Term& term, double start, double size, const Choice& choice);

}  // namespace ukemi::identify
