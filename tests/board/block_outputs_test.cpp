// The outputs that the events of `send` report: as the lines of the program have switched them.
#include "host/program/block_outputs.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "host/job/job.hpp"
#include "shared/boards/all_boards.hpp"

namespace lamplock::program_run {
namespace {

/// Not the level of 16 bits.
TEST(BlockOutputs, HaveTheShareOfTheProgram) {
  settings::Values values = job::default_profile().settings;
  values.set_milli(settings::Id::pin_map, static_cast<int>(boards::PinMap::cut_io) * 1000);
  BlockOutputs outputs(values, nullptr);
  for (const auto& [line, share] :
       {std::pair{"M67 E0 Q50", 0.5}, std::pair{"M68 E0 Q33.33", 0.3333}, std::pair{"M62 P0", 1.0},
        std::pair{"M63 P0", 0.0}}) {
    outputs.run(line);
    EXPECT_EQ(outputs.aux(), share) << line;
  }
}

}  // namespace
}  // namespace lamplock::program_run
