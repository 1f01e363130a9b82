// A job with two channels, slow shutters, sensors that miss shots, an energy for each run.
#pragma once

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {

struct BeamJob {
  BeamJob() {
    const auto set = [this](Id id, double value) {
      job::state_setting(profile, id, value, "test");
    };
    set(Id::shutter_open, 12);
    set(Id::shutter_close, 8);
    set(Id::attenuator_settle, 5);
    set(Id::shot_check, 2);
    set(Id::shot_repeats, 20);
    world = world_for(profile);
    world.shutters = {12 * ps_per_ms, 8 * ps_per_ms};
    world.photosensors.failure = 0.25;
    // The shortest permitted sensor pulse; the board reads it at most 100 us later.
    world.photosensors.answer = 2 * ps_per_us;
    world.photosensors.width = 10 * ps_per_us;
    job = job::make_job(chip_points(static_cast<std::size_t>(std::max(24, scaled(40))), 3), profile,
                        {});
    for (std::size_t i = 0; i < job.targets.size(); ++i) {
      job.targets[i].channel = i / 8 % 2 == 0 ? 1 : 3;
      job.targets[i].energy =
          static_cast<std::uint16_t>(i / 5 % 3 == 2 ? 65535 : 9000 + 700 * (i / 5));
    }
  }
  job::Profile profile = chip_profile(200);
  sim::WorldConfig world;
  job::Job job;
};

}  // namespace lamplock::test
