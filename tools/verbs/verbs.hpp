// The verbs of the program: each adds its subcommand and, when chosen, its action.
#pragma once

#include "tools/program/command.hpp"

namespace ukemi::tools {

void add_identify(CLI::App& app, Action& chosen);  // identify, predict
void add_simulate(CLI::App& app, Action& chosen);
void add_optimize(CLI::App& app, Action& chosen);
void add_calibrate(CLI::App& app, Action& chosen);
void add_compare(CLI::App& app, Action& chosen);
void add_design(CLI::App& app, Action& chosen);
void add_demo(CLI::App& app, Action& chosen);
void add_map(CLI::App& app, Action& chosen);
void add_ratings(CLI::App& app, Action& chosen);
void add_trade(CLI::App& app, Action& chosen);
void add_risk(CLI::App& app, Action& chosen);
void add_atlas(CLI::App& app, Action& chosen);
void add_robot(CLI::App& app, Action& chosen);

}  // namespace ukemi::tools
