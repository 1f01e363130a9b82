// A part with a hole as `lamplock cut` writes it: compensated lines and arcs, a lead, a tab.
// tests/run/cut_beam_test.cpp compares such light on the virtual board with the drawing.
#pragma once

#include <string>
#include <vector>

#include "host/cutting/cut_plan.hpp"
#include "host/cutting/post_file.hpp"
#include "tests/cutting/shapes.hpp"

namespace lamplock::test {

/// Begins with a long rapid. Compensated by the controller it has no lead and no tab.
inline std::string cut_part_program(bool by_controller = false) {
  cutting::Operation operation;
  operation.power = 0.8;
  operation.feed_mm_min = 6000;
  operation.kerf_mm = 0.2;
  if (by_controller) {
    operation.compensation = cutting::Compensation::controller;
  } else {
    operation.lead_in = {cutting::LeadShape::line, 0.3, 0.3, 90};
    operation.tabs = {1, 0.4, 0, 0.3};
  }
  std::vector<cutting::Shape> shapes{{rounded_rectangle({6, 3}, 5, 4, 1), {}, 0},
                                     {circle({8.5, 5}, 1), {}, 0}};
  cutting::place_shapes(shapes, {operation});
  const cutting::CutPlan plan = cutting::plan_cuts(shapes, {operation}, {0, 0});
  return cutting::cut_program(plan, {operation}, cutting::post_of("grbl"),
                              {"part", {"part", "hole"}, 1000});
}

}  // namespace lamplock::test
