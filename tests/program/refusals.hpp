// Lines that an interpreter refuses: the error, its column, and that the state is unchanged.
//
// In:  the lines, a type with an `interpreter` as configured by the test.
// Who: tests of single words.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <string_view>

#include "firmware/program/interpreter.hpp"

namespace lamplock::program::test {

struct Refusal {
  const char* line;
  GcodeError error;
  int column;
};

/// Runs each line on a new rig; "$J=" is a jog.
template <class Rig>
void expect_refused(std::span<const Refusal> refusals) {
  for (const Refusal& refusal : refusals) {
    Rig rig;
    const State before = rig.interpreter.state();
    const std::string_view line = refusal.line;
    const Fault fault =
        line.starts_with("$J=") ? rig.interpreter.jog(line.substr(3)) : rig.interpreter.run(line);
    EXPECT_EQ(fault.error, refusal.error) << line;
    EXPECT_EQ(fault.column, refusal.column) << line;
    Action action;
    EXPECT_FALSE(rig.interpreter.next(action)) << line;
    EXPECT_TRUE(rig.interpreter.state().modal == before.modal) << line;
    EXPECT_EQ(rig.interpreter.state().machine_e7, before.machine_e7) << line;
  }
}

}  // namespace lamplock::program::test
