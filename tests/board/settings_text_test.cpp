// Settings as text: changes are listed, kept over a restart, and refused when invalid.
#include <fmt/format.h>

#include "shared/pulse_times.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

std::string milli_text(std::int32_t milli) { return fmt::format("{:.3f}", milli / 1000.0); }

/// The setting that is refused is a rate that leaves no time for the pulses.
bool is_rate_excess(const settings::Values& values, std::uint16_t refused) {
  const settings::RateExcess excess = settings::rate_excess(values);
  return excess.axis >= 0 &&
         refused == settings::number(settings::for_axis(Id::max_rate_x, excess.axis));
}

std::string refusal(std::uint16_t setting) {
  return fmt::format("[MSG:${} contradicts other settings]\r\nerror:52\r\n", setting);
}

std::string rate_refusal(const settings::Values& values) {
  const settings::RateExcess excess = settings::rate_excess(values);
  return fmt::format("[MSG:${} at most {:.3f} mm/min with $0 and $1077]\r\nerror:12\r\n",
                     settings::number(settings::for_axis(Id::max_rate_x, excess.axis)),
                     static_cast<double>(excess.max_milli) / 1000);
}

/// What a virtual board that starts with these settings lacks: SENSOR, if its pin map has none.
boards::SettingLimits limits_of(const settings::Values& stored) {
  const auto map = static_cast<boards::PinMap>(stored.whole(Id::pin_map));
  boards::SettingLimits limits;
  limits.has_sensor = boards::find_gpio(map, boards::Role::sensor).has_value();
  return limits;
}

/// The answer to a setting after which the board would have these values; `refused`: the setting
/// that contradicts others, 0 if none does.
std::string answer_to(const boards::SettingLimits& limits, const settings::Values& asked,
                      std::uint16_t refused) {
  if (const Id unfit = boards::unfit_setting(limits, asked); unfit != Id::count)
    return fmt::format(
        "[MSG:${} needs SENSOR, which this pin map lacks on a board virtual]\r\nerror:52\r\n",
        settings::number(unfit));
  if (refused == 0) return "ok\r\n";
  return is_rate_excess(asked, refused) ? rate_refusal(asked) : refusal(refused);
}

TEST(SettingsText, EverySettingIsListedAndReadsBack) {
  Rig rig(lamp_profile());
  ProgramHost user(rig);
  const std::string list = user.answer("$$");
  EXPECT_THAT(list, EndsWith("ok\r\n"));
  std::size_t lines = 0;
  for (std::size_t at = 0; list[at] == '$'; at = list.find('\n', at) + 1, ++lines)
    EXPECT_EQ(user.answer(list.substr(at, list.find('\r', at) - at)), "ok\r\n");
  EXPECT_EQ(lines, settings::setting_count);
  EXPECT_EQ(rig.board.stored_settings(), lamp_profile().settings);
  EXPECT_EQ(user.answer("$$"), list);
}

TEST(SettingsText, RandomValuesAreKeptOverARestart) {
  std::mt19937_64 random(5);
  settings::Values wanted = lamp_profile().settings;
  wanted.set_milli(Id::hard_limits, 0);  // else an alarm as soon as $5 makes a switch engaged
  for (int round = 0; round < scaled(20); ++round) {
    // As a board does at its start, when the map of the round before has no SENSOR.
    const boards::SettingLimits limits_of_board = limits_of(wanted);
    boards::fit_settings(limits_of_board, wanted);
    Rig rig(wanted, world_for(lamp_profile()));
    ProgramHost user(rig);
    for (int i = 0; i < 30; ++i) {
      const auto id = static_cast<Id>(random() % settings::setting_count);
      // core_xy_test.cpp tests the settings of motors that axes share.
      if (id == Id::hard_limits || id == Id::kinematics || id == Id::ganged_axis) continue;
      const settings::Row& row = settings::row(id);
      std::int32_t value =
          std::uniform_int_distribution<std::int32_t>(row.min_milli, row.max_milli)(random);
      if (row.whole) value -= value % 1000;
      settings::Values asked = wanted;
      ASSERT_TRUE(asked.set_milli(id, value));
      motion::Limits limits;
      std::uint16_t refused = 0;
      if (motion::make_limits(asked, beat_ticks(asked), full_tick_q16, limits, refused) ==
          Result::ok)
        refused = lamp::broken_protection(asked);
      const std::string answer = answer_to(limits_of_board, asked, refused);
      EXPECT_EQ(user.answer(fmt::format("${}={}", row.number, milli_text(value))), answer);
      if (answer == "ok\r\n") wanted = asked;
      ASSERT_EQ(rig.board.stored_settings(), wanted);
    }
    EXPECT_TRUE(rig.monitor.nothing_happened());
  }
}

TEST(SettingsText, ValuesBeyondTheLasersLimitsAreRefused) {
  Rig rig(lamp_profile(50));
  ProgramHost user(rig);
  EXPECT_EQ(user.answer("$922=20"), "ok\r\n");  // 20 J at 50 Hz: 1000 W
  EXPECT_EQ(user.answer("$901=50.001"), refusal(922));
  EXPECT_EQ(user.answer("$922=20.001"), refusal(922));
  EXPECT_EQ(user.answer("$935=30"), "ok\r\n");
  EXPECT_EQ(user.answer("$922=20.001"), refusal(922));
  EXPECT_EQ(user.answer("$923=999.999"), refusal(922));
  EXPECT_EQ(user.answer("$910=1"), "ok\r\n");
  EXPECT_EQ(user.answer("$900=2"), refusal(922));  // triggered by the board, up to 1 % faster
  EXPECT_EQ(user.answer("$922=19.8"), "ok\r\n");
  EXPECT_EQ(user.answer("$900=2"), "ok\r\n");
  EXPECT_EQ(user.answer("$922=0"), refusal(922));  // triggering needs a known energy
  EXPECT_EQ(user.answer("$900=1"), "ok\r\n");
  EXPECT_EQ(user.answer("$922=0"), "ok\r\n");
  EXPECT_EQ(user.answer("$901=200"), "ok\r\n");
  EXPECT_EQ(user.answer("$929=4995"), "ok\r\n");  // the sensors are not used
  EXPECT_EQ(user.answer("$927=1"), refusal(929));
  EXPECT_EQ(user.answer("$929=200"), "ok\r\n");
  EXPECT_EQ(user.answer("$927=2"), "ok\r\n");
  EXPECT_EQ(user.answer("$901=1000"), refusal(929));  // the sensors answer after the next shot
  EXPECT_EQ(user.answer("$927=1"), "ok\r\n");
  EXPECT_EQ(user.answer("$901=1000"), "ok\r\n");
}

TEST(SettingsText, AnIncompleteLineEndsWithItsConnectionAndAtAReset) {
  Rig rig(lamp_profile());
  ProgramHost user(rig);
  const auto type = [&user](std::string_view text) {
    user.send(text);
    user.run_ms(10);
  };
  type("$110=6");
  rig.board.reconnect();
  EXPECT_EQ(user.answer("0"), "error:1\r\n");
  type("$110=6");
  EXPECT_THAT(user.answer("\x18"
                          "0"),
              AllOf(HasSubstr("Grbl 1.1"), EndsWith("error:1\r\n")));
  // An incomplete frame would swallow the line.
  type(
      "\x02"
      "abc");
  rig.board.reconnect();
  EXPECT_THAT(user.answer("$I"), EndsWith("ok\r\n"));
  EXPECT_EQ(rig.board.stored_settings(), lamp_profile().settings);
  // Without an interruption the two halves make one line.
  type("$110=6");
  EXPECT_EQ(user.answer("0"), "ok\r\n");
  EXPECT_EQ(rig.board.stored_settings().whole(Id::max_rate_x), 60);
}

TEST(SettingsText, UnknownSettingsAreRefusedByNumber) {
  Rig rig(lamp_profile());
  ProgramHost user(rig);
  for (const char* line : {"$q", "$=1", "$901", "$901x=1", "$902345=1", "$99999999999=1", "$7=1"})
    EXPECT_EQ(user.answer(line), "error:3\r\n") << line;
  for (const char* line :
       {"$901=", "$901=fast", "$901=1.2345", "$901=1e3", "$901=--1", "$901=99999999999999999999"})
    EXPECT_EQ(user.answer(line), "error:2\r\n") << line;
  for (const char* line : {"$901=0.999", "$901=8000.001", "$901=-100", "$960=2.5", "$900=3"})
    EXPECT_EQ(user.answer(line), "error:52\r\n") << line;
  EXPECT_EQ(user.answer("$111=599999"),  // more than one step per tick
            "[MSG:$111 at most 294000.000 mm/min with $0 and $1077]\r\nerror:12\r\n");
  EXPECT_EQ(rig.board.stored_settings(), lamp_profile().settings);
}

TEST(SettingsText, GarbageChangesNothingItDoesNotName) {
  Rig rig(lamp_profile());
  ProgramHost user(rig);
  std::mt19937_64 random(6);
  const std::string letters = "$=.0123456789-+eRSTXI\t ";
  for (int i = 0; i < scaled(300); ++i) {
    std::string line = "$";
    for (std::size_t n = random() % 12; n > 0; --n) line += letters[random() % letters.size()];
    const settings::Values before = rig.board.stored_settings();
    const std::string said = user.answer(line);
    if (said.find("error:") != std::string::npos) {
      EXPECT_EQ(rig.board.stored_settings(), before) << line;
    }
  }
  EXPECT_TRUE(rig.monitor.nothing_happened());
}

TEST(SettingsText, NothingIsChangedWhileTheMachineIsBusy) {
  const job::Profile profile = lamp_profile();
  Rig rig(profile);
  ProgramHost user(rig);
  const job::Job job = job::make_job(histogram_walk(200, 3), profile, {});
  link::SimulatedTransport transport(rig.board);
  link::JobSender sender(transport, job, session(1));
  while (rig.shots().size() < 50 && sender.step()) {
  }
  for (const char* line : {"$901=50", "$RST=$", "$RST=*", "$BOOT"})
    EXPECT_THAT(user.answer(line), HasSubstr("error:8\r\n")) << line;
  EXPECT_FALSE(rig.board.controller().loader_requested());
  EXPECT_EQ(rig.board.stored_settings(), profile.settings);
  EXPECT_EQ(sender.run().end, JobEnd::done);
  expect_each_once(rig, job, false);
}

TEST(SettingsText, DefaultsAreRestored) {
  Rig rig(lamp_profile(50));
  ProgramHost user(rig);
  EXPECT_EQ(user.answer("$RST=$"), "[MSG:Restoring defaults]\r\nok\r\n");
  EXPECT_EQ(rig.board.stored_settings(), settings::Values());
}

TEST(SettingsText, TheLoaderIsEnteredAtRestAndEndsEverything) {
  const job::Profile profile = lamp_profile();
  Rig rig(profile);
  ProgramHost user(rig);
  EXPECT_EQ(user.answer("$BOOT"), "ok\r\n");
  EXPECT_TRUE(rig.board.controller().loader_requested());
  EXPECT_ANY_THROW(run_job(rig, job::make_job(histogram_walk(5, 3), profile, {})));
  EXPECT_TRUE(rig.monitor.nothing_happened());
}

TEST(SettingsText, TheLoaderIsEnteredAtAnEStopToo) {
  const job::Profile profile = lamp_profile();
  Rig rig(profile);
  ProgramHost user(rig);
  rig.board.world().schedule(sim::Pin::estop, true, rig.now() + ps_per_ms);
  rig.board.run_until(rig.now() + 100 * ps_per_ms);
  ASSERT_EQ(rig.board.controller().state(), MachineState::estop);
  EXPECT_THAT(user.answer("$901=50"), HasSubstr("error:8\r\n")) << "any other command is refused";
  EXPECT_EQ(user.answer("$BOOT"), "ok\r\n");
  EXPECT_TRUE(rig.board.controller().loader_requested());
  EXPECT_TRUE(rig.monitor.nothing_happened());
}

}  // namespace
}  // namespace lamplock::test
