/// Problems at the edge of what is sensible, every row solved or refused with its reason. Run: fem_extremes
/// [ELEMENT ...] (default: q2_p1_discontinuous, q2_q1_taylor_hood, p2b_p1_discontinuous). Exit code 1 where another
/// row than the one that cannot be solved (stretch 2 between clamps) ends without a stable state.

#include <fmt/format.h>

#include <cstdio>

#include "tests/fem/verification/extremes.hpp"

int main(int count, char** arguments) {
  using namespace brachium::fem;
  std::vector<Formulation> elements;
  for (int i = 1; i < count; ++i) elements.push_back(formulation_named(arguments[i]));
  if (elements.empty())
    elements = {Formulation::q2_p1_discontinuous, Formulation::q2_q1_taylor_hood,
                Formulation::p2b_p1_discontinuous};
  bool met = true;
  for (const Formulation element : elements) {
    fmt::print("\n{}\n{:<52} {:<8} {:>5} {:>6} {:>6} {:>7} {:>6} {:>4} {:>8} {:>12} {:<14} {:>7}\n",
               to_string(element), "problem", "outcome", "steps", "newton", "chord", "augment", "relax",
               "cuts", "least J", "force N", "end state", "s");
    for (const verification::Extreme& row : verification::extremes(element)) {
      const verification::Outcome o = verification::outcome_of(row);
      const std::string state =
          o.negative_modes > 0 ? fmt::format("{} ({})", o.stability, o.negative_modes) : o.stability;
      fmt::print("{:<52} {:<8} {:>5} {:>6} {:>6} {:>7} {:>6} {:>4} {:>8.4f} {:>12.5g} {:<14} {:>7.2f}\n",
                 row.name, o.solved ? "solved" : "stopped", o.steps, o.newton, o.chord, o.augmentations,
                 o.relaxation, o.cut_backs, o.smallest_jacobian, o.force_n, state, o.seconds);
      if (!o.solved) fmt::print("    {}\n", o.reason);
      std::fflush(stdout);
      met = met && ((o.solved && o.stability == "stable") || row.name == "stretch 2, passive, clamped");
    }
  }
  return met ? 0 : 1;
}
