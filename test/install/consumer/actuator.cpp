// Links the smallest library of a project that holds ukemi as a part of it.
#include <cstdio>

#include <ukemi/actuator.hpp>

int main() {
  ukemi::Actuator actuator;
  actuator.name = "mine";
  actuator.sea = {.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085};
  std::fputs(to_toml(actuator).c_str(), stdout);
}
