#include "identify/estimate/term.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi::identify {

bool Choice::fits(const std::string& term) const {
  const auto among = [&](const auto& list) { return std::find(list.begin(), list.end(), term) != list.end(); };
  return among(free) || among(nuisance);
}

void Choice::remove(const std::string& term) {
  std::erase(nuisance, term);
  std::erase_if(priors, [&](const Prior& p) { return p.term == term; });
}

std::size_t index_of(const std::vector<const Term*>& table, const std::string& what, const std::string& name) {
  std::vector<std::string> known;
  for (const Term* t : table) known.push_back(t->name);
  const auto at = std::find(known.begin(), known.end(), name);
  if (at == known.end()) throw InputError(what + ": " + one_of(name, known));
  return std::size_t(at - known.begin());
}

double Choice::lower_of(const Term& t) const {
  const auto at = lower.find(t.name);
  return at == lower.end() ? t.lower : at->second;
}
double Choice::upper_of(const Term& t) const {
  const auto at = upper.find(t.name);
  return at == upper.end() ? t.upper : at->second;
}

namespace {

void check_names(const std::vector<const Term*>& table, const Choice& c) {
  const auto check = [&](const char* what, const std::vector<std::string>& list, Term::Role wanted) {
    std::vector<const Term*> among;
    for (const Term* t : table)
      if (t->role == wanted) among.push_back(t);
    for (auto name = list.begin(); name != list.end(); ++name) {
      (void)index_of(among, what, *name);
      if (std::find(list.begin(), name, *name) != name)
        throw InputError(fmt::format("{}: {}: given twice", what, *name));
    }
  };
  check("free", c.free, Term::Role::kConstant);
  check("nuisance", c.nuisance, Term::Role::kNuisance);
  if (c.free.empty()) throw InputError("nothing to fit: at least one free constant is needed");
  for (const auto* bounds : {&c.lower, &c.upper})
    for (const auto& [name, value] : *bounds) (void)index_of(table, "bounds", name);
}

}  // namespace

void validate(const std::vector<const Term*>& table, const Choice& c) {
  check_names(table, c);
  for (const Term* t : table) {
    const double lower = c.lower_of(*t), upper = c.upper_of(*t);
    if (t->lower >= 0 && !(lower >= 0))
      throw InputError(fmt::format("lower bound of {}: {}: must be at least 0", t->name, shortest(lower)));
    if (!(lower < upper))
      throw InputError(
          fmt::format("bounds of {}: {} to {}: lower < upper is needed", t->name, shortest(lower), shortest(upper)));
  }
  for (const Prior& p : c.priors) {
    (void)index_of(table, "prior", p.term);
    if (std::count_if(c.priors.begin(), c.priors.end(), [&](const Prior& q) { return q.term == p.term; }) > 1)
      throw InputError(fmt::format("prior of {}: given twice", p.term));
    if (!std::isfinite(p.value))
      throw InputError(fmt::format("prior of {}: {}: a finite number is needed", p.term, shortest(p.value)));
    if (!(p.std > 0 && std::isfinite(p.std)))
      throw InputError(fmt::format("prior of {}: {}: a standard deviation above 0 is needed", p.term, shortest(p.std)));
    if (!c.fits(p.term)) throw InputError(fmt::format("prior of {}: it is not fitted", p.term));
  }
}

Parameter parameter_of(const Term& t, double start, double size, const Choice& c) {
  double lower = c.lower_of(t);
  if (t.smallest_part > 0) lower = std::max(lower, t.smallest_part * size);
  return {t.name, t.unit, start, lower, c.upper_of(t), size};
}

}  // namespace ukemi::identify
