// The solvers of `optimize`: each spends the budget of a Search in its own way.
#pragma once

#include <string>
#include <vector>

#include "landing/search/search.hpp"

namespace ukemi::landing {

/// auto; the paper's sqp, pattern and ga; de, cma; NLopt's crs2, direct_l, isres, esch, mlsl, sbplx, nelder_mead,
/// cobyla, bobyqa; random.
const std::vector<std::string>& solver_names();
/// Throws InputError for a name that is not one of them.
void check_solver(const std::string& name);
/// Runs until search.over(). Deterministic for the search's seed and a number of motions.
void run_solver(const std::string& name, Search& search);

/// See auto_search.hpp.
void auto_search(Search& search);
/// Covariance matrix adaptation (cma.hpp) from the centre of the box, then from random starts.
void covariance_adaptation(Search& search);
/// Differential evolution, best/1/bin with a dithered factor (Storn, Price 1997).
void differential_evolution(Search& search);
/// A genetic algorithm on real numbers: tournaments of two, blend crossover, Gaussian mutation, one elite.
void genetic_algorithm(Search& search);
/// Generalised pattern search (Torczon 1997): polls both ways along every variable in one batch, halves its mesh on
/// failure, and restarts at random once the mesh is fine.
void pattern_search(Search& search);
/// NLopt's SLSQP on the epigraph min s, a_k <= s over the largest peaks of the landing, with exact gradients; from the
/// centre of the box, then from random starts. Under scatter on the measure over some of the drops.
void sequential_quadratic(Search& search);
/// The same from a start, at a fidelity with gradient_rows; returns the best point that it evaluated.
Candidate descend_by_gradient(Search& search, Fidelity fidelity, const Candidate& start);
/// One of NLopt's algorithms without derivatives; a local one restarts at random until the search is over.
void nlopt_search(const std::string& name, Search& search);
void random_search(Search& search);

}  // namespace ukemi::landing
