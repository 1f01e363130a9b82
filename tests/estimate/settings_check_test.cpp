// A job is made only with settings that a board accepts.
#include "host/estimate/settings_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "host/error.hpp"
#include "host/job/job.hpp"
#include "host/job/profile.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/lamp_settings.hpp"

namespace lamplock::estimate::settings_check_test {
namespace {

using settings::Id;
using testing::HasSubstr;

job::Profile profile_with(std::initializer_list<std::pair<Id, double>> values) {
  job::Profile profile = job::default_profile();
  for (const auto& [id, value] : values) job::state_setting(profile, id, value, "test");
  return profile;
}

std::string refusal(const job::Profile& profile) {
  try {
    check_settings(profile.settings);
  } catch (const Error& error) {
    return std::string(error.message());
  }
  return "";
}

/// What the virtual board says to a job; empty: it fires its first point.
std::string answer_of_board(const job::Profile& profile) {
  sim::WorldConfig world;
  world.lamp = sim::lamp_of(profile.settings);
  sim::VirtualBoard board(profile.settings, world);
  link::SimulatedTransport transport(board);
  link::SenderOptions options;
  options.session = 1;
  const job::Job job = job::make_job({{0, 0, 0}, {0.1, 0, 0}}, profile, {});
  link::JobSender sender(transport, job, options);
  try {
    while (sender.status().shots == 0 && sender.step()) {
    }
  } catch (const Error& error) {
    return std::string(error.message());
  }
  return sender.status().shots != 0 ? "" : "no shot";
}

TEST(SettingsCheck, NamesWhatContradictsAndWhatToChange) {
  EXPECT_EQ(refusal(job::default_profile()), "");
  EXPECT_THAT(refusal(profile_with({{Id::lamp_frequency, 8000}})),
              HasSubstr("q_switch_width = 150 us: with q_switch_delay = 5 us a shot does not end "
                        "within a beat at 8000 Hz; give a shorter q_switch_width"));
  EXPECT_THAT(refusal(profile_with({{Id::lamp_mode, 2}})),
              HasSubstr("lamp_energy = 0 J: a machine that triggers its lamp must know"));
  EXPECT_THAT(
      refusal(profile_with({{Id::lamp_mode, 2}, {Id::lamp_energy, 1}, {Id::lamp_frequency, 300}})),
      HasSubstr("lamp_frequency = 300 Hz: a lamp that the machine triggers may flash at "
                "200 Hz (max_lamp_frequency)"));
  EXPECT_THAT(refusal(profile_with({{Id::lamp_energy, 15}})), HasSubstr("lamp_power 1000 W"));
  EXPECT_THAT(refusal(profile_with({{Id::shot_check, 2}, {Id::lamp_frequency, 1000}})),
              HasSubstr("sensor_time"));
}

TEST(SettingsCheck, AgreesWithTheBoard) {
  std::mt19937 random(3);
  const auto one_of = [&random](std::initializer_list<double> values) {
    return values.begin()[random() % values.size()];
  };
  int refused = 0;
  constexpr int cases = 150;
  for (int i = 0; i < cases; ++i) {
    const job::Profile profile =
        profile_with({{Id::lamp_frequency, one_of({50, 100, 190, 600, 2000, 5000})},
                      {Id::lamp_mode, one_of({1, 2})},
                      {Id::lamp_energy, one_of({0, 1, 6})},
                      {Id::q_switch_delay, one_of({5, 40})},
                      {Id::q_switch_width, one_of({50, 170, 500})},
                      {Id::max_lamp_frequency, one_of({100, 2000})},
                      {Id::shot_check, one_of({0, 0, 1, 2})}});
    const std::string why = refusal(profile);
    refused += why.empty() ? 0 : 1;
    const std::string answer = answer_of_board(profile);
    ASSERT_EQ(answer.empty(), why.empty()) << why << answer;
  }
  EXPECT_GT(refused, cases / 5);
  EXPECT_LT(refused, cases * 4 / 5);
}

}  // namespace
}  // namespace lamplock::estimate::settings_check_test
