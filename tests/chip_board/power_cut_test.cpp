// Power fails at random moments while settings are written: the next start finds the old set or the
// new one.
#include <fmt/format.h>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// Settings as `$$` lists them; empty if the list is incomplete.
std::optional<settings::Values> listed(ChipRig& rig) {
  const std::string list = rig.answer("$$");
  settings::Values values;
  std::size_t count = 0;
  for (std::size_t at = list.find('$'); at != std::string::npos; at = list.find('$', at + 1)) {
    const auto number = static_cast<std::uint16_t>(std::stoi(list.substr(at + 1)));
    const double value = std::stod(list.substr(list.find('=', at) + 1));
    if (!values.set_milli(settings::find_number(number),
                          static_cast<std::int32_t>(std::lround(value * 1000))))
      return std::nullopt;
    ++count;
  }
  // The image of a Pico has no settings of drives, and none of the loop of a sensor.
  std::size_t all = 0;
  for (int i = 0; i < static_cast<int>(Id::drive_current_x); ++i)
    if (!settings::needs_sensor(settings::number(static_cast<Id>(i)))) ++all;
  if (count != all) return std::nullopt;
  return values;
}

class PowerCut : public testing::Test {
 protected:
  Picoseconds up_to(Picoseconds most) {
    return std::uniform_int_distribution<Picoseconds>(0, most)(random_);
  }
  bool one_in(int n) { return std::uniform_int_distribution<>(1, n)(random_) == 1; }
  /// A line that changes one of some settings.
  std::string change(settings::Values& values) {
    constexpr Id ids[] = {Id::lamp_frequency, Id::travel_x, Id::acceleration_y, Id::dead_man,
                          Id::q_switch_delay};
    const Id id = ids[random_() % std::size(ids)];
    const settings::Row& row = settings::row(id);
    const std::int32_t value = row.default_milli -
                               1000 * static_cast<std::int32_t>(1 + random_() % 2) -
                               static_cast<std::int32_t>(random_() % 700);
    EXPECT_TRUE(values.set_milli(id, value));
    return fmt::format("${}={:.3f}", row.number, value / 1000.0);
  }

  std::mt19937_64 random_{20260101};
};

TEST_F(PowerCut, WhileSettingsAreWritten) {
  settings::Values old = chip_profile().settings;
  ChipRig rig(old, world_for(chip_profile()));
  int kept_old = 0, kept_new = 0, in_program = 0, in_erase = 0;
  const int cuts = scaled(25, 25);
  for (int cut = 0; cut < cuts; ++cut) {
    SCOPED_TRACE(testing::Message() << "cut " << cut);
    // Complete writes before it, so that all places of all sectors are used.
    for (auto writes = random_() % 5; writes > 0; --writes) {
      const std::string line = change(old);
      ASSERT_EQ(rig.answer(line), "ok\r\n") << line;
      ASSERT_EQ(rig.board.stored_settings(), old);
    }
    settings::Values wanted = old;
    const std::string line = change(wanted);
    rig.type(line + "\n");
    sim::chip::FlashChip& flash = rig.board.chip().flash();
    if (one_in(4)) {
      rig.run(up_to(3 * ps_per_ms));  // before, during or after the write
    } else {
      // During a flash operation, or right after it.
      const Picoseconds limit = rig.now() + 5 * ps_per_ms;
      while (!flash.busy(rig.now()) && rig.now() < limit) rig.run(10 * ps_per_us);
      rig.run(up_to(std::max<Picoseconds>(0, (flash.busy_until() - rig.now()) * 11 / 10)));
    }
    if (flash.busy(rig.now()))
      (flash.busy_until() - rig.now() > ps_per_ms ? in_erase : in_program) += 1;
    rig.board.power_cut();
    EXPECT_EQ(rig.energy.levels(), 0u);
    while (one_in(4)) {  // and again while it starts
      rig.run(up_to(12 * ps_per_ms));
      rig.board.power_cut();
    }
    const settings::Values kept = rig.board.stored_settings();
    ASSERT_TRUE(kept == old || kept == wanted) << line;
    (kept == old ? kept_old : kept_new) += 1;
    rig.boot();
    if (cut % 4 == 0) {
      ASSERT_EQ(listed(rig), kept);
    }
    old = kept;
  }
  std::printf("kept old %d, new %d; in a program %d, in an erase %d; sectors erased %llu\n",
              kept_old, kept_new, in_program, in_erase,
              static_cast<unsigned long long>(rig.board.chip().flash().counts().sectors_erased));
  EXPECT_GT(kept_old, 0);
  EXPECT_GT(kept_new, 0);
  EXPECT_GT(in_program, cuts / 4);
  EXPECT_GT(in_erase, 0);
  EXPECT_TRUE(rig.monitor.nothing_happened());
  EXPECT_FALSE(rig.energy.any_high_within(0, rig.now()));
}

}  // namespace
}  // namespace lamplock::test
