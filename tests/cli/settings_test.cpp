// `lamplock settings` on the virtual board and over a port, where changes persist.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "shared/settings_table.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<std::string> settings(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"settings"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return all;
}

TEST(Settings, lists_the_whole_table) {
  const Finished listed = run(settings({"list", "--json"}));
  ASSERT_EQ(listed.status, 0) << listed.err;
  const auto document = nlohmann::json::parse(listed.out);
  ASSERT_EQ(document.size(), lamplock::settings::setting_count);
  for (const auto& row : document) EXPECT_EQ(row["value"], row["default"]) << row;
  EXPECT_EQ(document[0]["name"], "step_pulse");
  const Finished text = run(settings({"list"}));
  EXPECT_THAT(text.out, HasSubstr("lamp_frequency"));
  EXPECT_THAT(text.out, HasSubstr("nominal lamp frequency"));
}

TEST(Settings, gets_one) {
  const Folder folder;
  const std::string machine = folder.write("m.toml", "lamp_frequency = 55\n");
  EXPECT_EQ(run(settings({"get", "lamp_frequency", "--machine", machine})).out,
            "$901 lamp_frequency: 55.000 Hz\n");
  EXPECT_EQ(run(settings({"get", "$901", "30"})).out,
            "$901 lamp_frequency: 100.000 Hz\n$30 max_spindle_speed: 1000 S\n");
  EXPECT_EQ(run(settings({"get", "901", "30", "--value"})).out, "100.000\n1000\n");
  const auto both = nlohmann::json::parse(run(settings({"get", "901", "30", "--json"})).out);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1]["name"], "max_spindle_speed");
  EXPECT_EQ(nlohmann::json::parse(run(settings({"get", "901", "--json"})).out)["unit"], "Hz");
  const Finished none = run(settings({"get", "colour"}));
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("there is no setting 'colour'"));
  EXPECT_THAT(run(settings({"get", "lamp_frequencey"})).err,
              HasSubstr("did you mean 'lamp_frequency'?"));
  EXPECT_EQ(run(settings({"get", "12345"})).status, 2);
  for (const char* zeros : {"00", "0901", "$00"}) {
    const Finished refused = run(settings({"get", zeros}));
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("leading zeros"));
  }
}

TEST(Settings, are_set_by_former_names_with_a_note) {
  const Finished set = run(settings({"set", "highest_speed=255"}));
  EXPECT_EQ(set.status, 0);
  EXPECT_EQ(lines(set.out)[0], "$30 max_spindle_speed: 1000 -> 255 S");
  EXPECT_EQ(set.err, "note: highest_speed=255: 'highest_speed' is now named 'max_spindle_speed'\n");
  const Finished get = run(settings({"get", "highest_speed"}));
  EXPECT_EQ(get.out, "$30 max_spindle_speed: 1000 S\n");
  EXPECT_EQ(get.err,
            "note: lamplock settings get: 'highest_speed' is now named 'max_spindle_speed'\n");
  const Folder folder;
  const std::string machine = folder.write("m.toml", "highest_speed = 255\n");
  const Finished restored = run(settings({"restore", machine}));
  EXPECT_EQ(lines(restored.out)[0], "$30 max_spindle_speed: 1000 -> 255 S");
  EXPECT_EQ(lines(restored.err).size(), 1u) << restored.err;
}

TEST(Settings, sets_several_or_none) {
  const Finished done = run(settings({"set", "acceleration_x=500", "901=50", "axes=3"}));
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(lines(done.out)[0], "$120 acceleration_x: 4000.000 -> 500.000 mm/s2");
  EXPECT_EQ(lines(done.out)[1], "$901 lamp_frequency: 100.000 -> 50.000 Hz");
  EXPECT_THAT(done.out, Not(HasSubstr("axes")));
  const Finished wrong = run(settings({"set", "acceleration_x=500", "axes=9"}));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("axes = 9 is out of range"));
  EXPECT_EQ(wrong.out, "");
  EXPECT_EQ(run(settings({"set", "120=1", "acceleration_x=2"})).status, 2);
}

TEST(Settings, a_loop_without_a_sensor_is_refused_with_the_reason) {
  const Finished refused = run(settings({"set", "loop=1"}));
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("the board has no SENSOR with this pin map; nothing was "
                                     "changed; leave it out, or choose a board"));
}

TEST(Settings, pulses_that_the_rates_leave_no_time_for_are_refused_with_the_highest_rate) {
  constexpr const char* reason = "max_rate_x may be at most 49000 mm/min with the present pulses";
  const Finished set = run(settings({"set", "step_pulse=2.5", "step_low=2.5"}));
  EXPECT_EQ(set.status, 1);
  EXPECT_THAT(set.err, HasSubstr(reason));
  EXPECT_THAT(set.err, HasSubstr("nothing was changed; lower it, or shorten step_pulse"));
  const Finished slower = run(
      settings({"set", "step_pulse=2.5", "step_low=2.5", "110=49000", "111=49000", "112=49000"}));
  EXPECT_EQ(slower.status, 0) << slower.err;
  const Folder folder;
  const std::string machine = folder.write("m.toml", "step_pulse = 2.5\nstep_low = 2.5\n");
  const std::string points = folder.write("a.xyz", "0 0 0\n1 1 0\n");
  const std::string program = folder.write("a.ngc", "G1 X5 F600\nM2\n");
  for (const std::vector<std::string>& command : {std::vector<std::string>{"engrave", points},
                                                  {"estimate", points},
                                                  {"check", program},
                                                  {"send", program}}) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"--machine", machine});
    const Finished refused = run(arguments);
    EXPECT_EQ(refused.status, 2) << command[0];
    EXPECT_THAT(refused.err, HasSubstr(reason)) << command[0];
  }
}

TEST(Settings, are_restored_from_files) {
  const Folder folder;
  const std::string machine =
      folder.write("m.toml", "travel = [300, 200, 100]\nlamp_mode = 2\nlamp_energy = 1\n");
  for (const char* name : {"b.toml", "b.txt"}) {
    const std::string file = folder / name;
    EXPECT_EQ(run(settings({"backup", file, "--machine", machine})).status, 0);
    const Finished same = run(settings({"restore", file, "--machine", machine}));
    EXPECT_EQ(same.status, 0) << same.err;
    EXPECT_EQ(same.out, "nothing differs\n");
    const Finished other = run(settings({"restore", file, "--json"}));
    EXPECT_EQ(other.status, 0) << other.err;
    const auto changes = nlohmann::json::parse(other.out);
    ASSERT_EQ(changes.size(), 4u) << other.out;
    EXPECT_EQ(changes[0]["number"], 130);
    EXPECT_EQ(changes[0]["after"], "300.000");
  }
  EXPECT_EQ(
      run({"check", folder.write("a.ngc", "G0 X140\n"), "--machine", folder / "b.toml"}).status, 0)
      << "a backup must be a machine profile";
}

TEST(Settings, of_another_board_are_not_restored) {
  const Folder folder;
  for (const char* file : {"b.toml", "b.txt"}) {
    const bool is_toml = std::string(file).ends_with("toml");
    const Finished refused =
        run(settings({"restore", folder.write(file, is_toml ? "pin_map = 3\ntravel_x = 200\n"
                                                            : "$130=200\n$990=3\n")}));
    EXPECT_EQ(refused.status, 2) << refused.out;
    EXPECT_THAT(refused.err, HasSubstr("is for the board picobob (pin_map = 3), the connected one "
                                       "is pico (pin_map = 0); use a file of pico"));
  }
}

#ifdef LAMPLOCK_HAS_FIRMWARE
// The simulated board has the settings of drives with a UART, a Pico does not.
TEST(Settings, of_a_board_with_more_of_them_are_restored) {
  const Folder folder;
  const std::string file = folder / "b.toml";
  EXPECT_EQ(run(settings({"backup", file})).status, 0);
  const Finished restored = run({"settings", "restore", file, "--board", "chip"});
  EXPECT_EQ(restored.status, 0) << restored.err;
  const Finished other =
      run({"settings", "restore", folder.write("c.toml", "drive_current_x = 700\n"), "--board",
           "chip"});
  EXPECT_EQ(other.status, 2) << other.out;
  EXPECT_THAT(other.err, HasSubstr("the board has no such setting"));
}
#endif

TEST(Settings, wrong_files_are_reported_by_line) {
  const Folder folder;
  const auto restore = [&](const char* name, const char* text) {
    const Finished ended = run(settings({"restore", folder.write(name, text)}));
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(lines(ended.err).size(), 1u) << ended.err;
    return ended.err;
  };
  EXPECT_THAT(restore("a.txt", "$100=200 (x, step/mm)\n\n$120=quick\n"), HasSubstr("a.txt:3: "));
  EXPECT_THAT(restore("b.txt", "hello\n"), HasSubstr("b.txt:1: 'hello' is not a setting"));
  EXPECT_THAT(restore("c.toml", "axes = 3\nlamp_mode = 7\n"), HasSubstr("c.toml:2: "));
  EXPECT_THAT(restore("f.txt", "$100=200\n$100=300\n"), HasSubstr("f.txt:2: the setting is given"));
  EXPECT_THAT(restore("d.txt", "; nothing\n"), HasSubstr("has no settings"));
  EXPECT_THAT(restore("e.txt", "$100=200\n$31=0\n"), HasSubstr("$31: the board has no such"));
}

TEST(Settings, persist_on_a_board_at_a_port) {
  const Folder folder;
  const Running sim({"sim", "--pty", folder / "port"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  const std::string port = folder / "port";
  const Finished done = run(settings({"set", "lamp_frequency=50", "--board", port}));
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(run(settings({"get", "901", "--board", port, "--value"})).out, "50.000\n");
}

TEST(Settings, a_hold_is_named_with_the_way_to_end_it) {
  const Folder folder;
  const Running sim({"sim", "--pty", folder / "port"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  const std::string port = folder / "port";
  run({"console", "--board", port}, "!\n");
  const Finished held = run(settings({"set", "lamp_frequency=50", "--board", port}));
  EXPECT_EQ(held.status, 1);
  EXPECT_THAT(held.err, HasSubstr("; nothing was changed; resume it with ~ in lamplock console"));
  run({"console", "--board", port}, "~\n");
  EXPECT_EQ(run(settings({"set", "lamp_frequency=50", "--board", port})).status, 0);
}

TEST(Settings, without_a_board) {
  const Finished none = run(settings({"list", "--board", "/dev/no-such-port"}));
  EXPECT_EQ(none.status, 3);
  EXPECT_THAT(none.err, HasSubstr("there is no such port"));
}

}  // namespace
}  // namespace lamplock::cli::test
