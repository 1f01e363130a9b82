// Set-up of drives on the board against the model of the TMC2209: never enabled with an unknown
// set-up, whatever happens on the wire.
#include "firmware/boards/rp2040/drives/drive_setup.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "shared/boards/rows/skr_pico.hpp"
#include "sim/world/tmc2209.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

using rp2040::DriveSetup;
using settings::Id;
using sim::Picoseconds;
using sim::ps_per_s;
using sim::ps_per_us;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The UART of the drives with its wire; a byte takes 87 us.
struct WireUart {
  static constexpr std::uint32_t byte_us = 87;
  static constexpr Picoseconds bit = ps_per_s / 115'200;

  void write(std::uint8_t byte) { sending.push_back(byte); }
  int read() {
    if (received.empty()) return -1;
    const int byte = received.front();
    received.pop_front();
    return byte;
  }
  /// One byte of time passes.
  void run() {
    now_us += byte_us;
    if (!replying.empty()) {
      deliver(replying.front(), false);
      replying.pop_front();
    } else if (!sending.empty()) {
      deliver(sending.front(), true);
      sending.pop_front();
    }
  }
  /// A byte on the wire reaches the chip, and if the chip has sent it, the drives.
  void deliver(std::uint8_t byte, bool is_sent) {
    ++bytes;
    int heard = byte;
    bool is_lost = false;
    if (fault) fault(heard, byte, is_lost);
    if (!is_lost) received.push_back(heard);
    if (!is_sent) return;
    for (const std::uint8_t reply : wire.receive(byte, Picoseconds{now_us} * ps_per_us, bit))
      replying.push_back(reply);
  }

  sim::TmcWire wire{boards::skr_pico.drives->addresses};
  std::deque<std::uint8_t> sending, replying;
  std::deque<int> received;
  /// May change what the chip hears, what the drives hear, or lose the byte for the chip.
  std::function<void(int& heard, std::uint8_t& sent, bool& is_lost)> fault;
  std::uint32_t now_us = 1000;
  std::size_t bytes = 0;
};

struct DriveRig {
  explicit DriveRig(const settings::Values& of = {}) : values(of) {
    setup.begin(values, 4, 0, uart.now_us);
  }
  void run(std::uint32_t us, bool at_rest = true) {
    for (const std::uint32_t end = uart.now_us + us; uart.now_us < end;) {
      uart.run();
      setup.service(uart.now_us, at_rest,
                    [this](std::string_view line) { messages.emplace_back(line); });
      if (setup.ready()) expect_set_up();
    }
  }
  /// All drives are as the settings ask for.
  void expect_set_up() {
    for (int axis = 0; axis < 4; ++axis) {
      const sim::Tmc2209& drive = uart.wire.drives[static_cast<std::size_t>(axis)];
      const double wanted = values.whole(Id::drive_current_x, axis);
      const double current = drive.current_ma(boards::skr_pico.drives->sense_mohm);
      const bool is_right =
          drive.is_powered() && current <= wanted + 0.1 && current > wanted - 56 &&
          drive.microsteps() == static_cast<unsigned>(values.whole(Id::microsteps_x, axis)) &&
          (drive.read(0x00) >> 2 & 1) ==
              static_cast<unsigned>(values.whole(Id::spread_cycle) >> axis & 1) &&
          (drive.read(0x00) & 1) == 0 && drive.written(0x22) == 0;
      if (!is_right && uart.now_us > excused_until_us) ++unknown;
    }
  }
  settings::Values values;
  WireUart uart;
  DriveSetup<WireUart> setup{uart, *boards::skr_pico.drives};
  std::vector<std::string> messages;
  std::size_t unknown = 0;  ///< rounds with drives enabled that are not set up
  /// A drive has lost its set-up, which is seen when it is asked next.
  std::uint32_t excused_until_us = 0;
};

TEST(DriveSetup, SetsUpAllAxes) {
  settings::Values values;
  values.set_milli(Id::drive_current_x, 800'000);
  values.set_milli(Id::drive_current_z, 1'200'000);
  values.set_milli(Id::microsteps_y, 256'000);
  values.set_milli(Id::spread_cycle, 4'000);
  DriveRig rig(values);
  EXPECT_FALSE(rig.setup.settled());
  rig.run(120'000);
  EXPECT_TRUE(rig.setup.ready());
  EXPECT_TRUE(rig.setup.settled());
  EXPECT_THAT(rig.messages, IsEmpty());
  rig.run(1'000'000);
  EXPECT_TRUE(rig.setup.ready());
  EXPECT_EQ(rig.unknown, 0u);
}

/// The formula of the datasheet (9): never more than asked for, and the next step would be.
TEST(DriveSetup, ChoosesTheHighestCurrentThatIsPermitted) {
  for (std::uint32_t ma = 50; ma <= 1700; ma += 7) {
    const auto scale = rp2040::tmc::scale_of(ma, 110);
    const auto current = [&](int cs) {
      return (cs + 1) / 32.0 * (scale.fine ? 180 : 325) / 0.13 / std::numbers::sqrt2;
    };
    EXPECT_LE(current(scale.cs), ma + 0.1) << ma;
    if (scale.cs < 31) {
      EXPECT_GT(current(scale.cs + 1), ma) << ma;
    }
  }
}

TEST(DriveSetup, SaysOnceThatADriveIsSilentAndGoesOnWithItsSupply) {
  DriveRig rig;
  for (sim::Tmc2209& drive : rig.uart.wire.drives) drive.set_powered(false);
  rig.run(3'000'000);
  EXPECT_TRUE(rig.setup.failed());
  EXPECT_TRUE(rig.setup.settled());
  EXPECT_THAT(rig.messages,
              ElementsAre("Drives off: X does not answer; switch the supply of the motors on"));
  for (sim::Tmc2209& drive : rig.uart.wire.drives) drive.set_powered(true);
  rig.run(1'000'000);
  EXPECT_TRUE(rig.setup.ready());
  EXPECT_EQ(rig.messages.size(), 1u);
}

TEST(DriveSetup, KeepsDrivesOffWithWrongCrcs) {
  DriveRig rig;
  rig.uart.fault = [&](int& heard, std::uint8_t&, bool&) {
    if (!rig.uart.replying.empty()) heard ^= 0x10;
  };
  rig.run(2'000'000);
  EXPECT_FALSE(rig.setup.ready());
  EXPECT_THAT(rig.messages, ElementsAre(HasSubstr("X answers with errors")));
}

TEST(DriveSetup, RefusesACurrentAboveTheLimit) {
  DriveRig rig;
  rig.setup.begin(rig.values, 4, 1093, rig.uart.now_us);
  rig.run(1'000'000);
  EXPECT_FALSE(rig.setup.ready());
  EXPECT_EQ(rig.uart.bytes, 0u);
  EXPECT_THAT(rig.messages, ElementsAre(HasSubstr("$1093 is not permitted on this board")));
}

TEST(DriveSetup, SeesAResetHeatAndAShortAtRestOnly) {
  struct Case {
    std::uint32_t flags;
    const char* message;
  };
  for (const Case& c : {Case{sim::Tmc2209::too_hot, "Y is too hot"},
                        Case{sim::Tmc2209::short_b, "Y has a short"}}) {
    DriveRig rig;
    rig.run(120'000);
    rig.uart.wire.drives[1].set_status(c.flags);
    rig.run(1'000'000, false);
    EXPECT_TRUE(rig.setup.ready()) << "in motion the wire is quiet";
    rig.run(1'000'000);
    EXPECT_FALSE(rig.setup.ready());
    EXPECT_THAT(rig.messages, ElementsAre(HasSubstr(c.message)));
  }
  // The cause has ended before it was looked at.
  DriveRig brief;
  brief.run(120'000);
  brief.uart.wire.drives[1].set_status(sim::Tmc2209::short_a);
  brief.uart.wire.drives[1].set_status(0);
  brief.run(1'000'000);
  EXPECT_THAT(brief.messages, testing::Contains(HasSubstr("Drives off: Y was off for heat")));
  DriveRig low;
  low.run(120'000);
  low.uart.wire.drives[0].set_low_supply(true);
  low.run(1'000'000);
  EXPECT_FALSE(low.setup.ready());
  EXPECT_THAT(low.messages, ElementsAre(HasSubstr("Drives off: X has too low a supply")));
  low.uart.wire.drives[0].set_low_supply(false);
  low.run(2'000'000);
  EXPECT_TRUE(low.setup.ready());
  DriveRig rig;
  rig.run(120'000);
  rig.uart.wire.drives[2].set_status(sim::Tmc2209::warm);
  rig.run(2'000'000);
  EXPECT_TRUE(rig.setup.ready());
  EXPECT_THAT(rig.messages, ElementsAre(HasSubstr("Drive Z is warm")));
  rig.excused_until_us = rig.uart.now_us + 450'000;
  rig.uart.wire.drives[3].power_up();
  rig.run(450'000);
  // After its reset it answers too early for a wire with others.
  EXPECT_THAT(rig.messages, testing::Contains(HasSubstr("Drives off: A answers with errors")));
}

/// Damaged, lost and inserted bytes in either direction, drives without power for a moment: the
/// drives are enabled only as set up, and are again when the wire is sound.
TEST(DriveSetup, IsNeverReadyWithAnUnknownSetUp) {
  std::mt19937 random(5);
  std::size_t faults = 0, readies = 0, rigs = 0;
  const auto wanted = static_cast<std::size_t>(scaled(1000));
  while (faults < wanted) {
    settings::Values values;
    for (int axis = 0; axis < 4; ++axis) {
      values.set_milli(settings::for_axis(Id::drive_current_x, axis),
                       static_cast<std::int32_t>(100 + random() % 1100) * 1000);
      values.set_milli(settings::for_axis(Id::microsteps_x, axis), 1000 << random() % 9);
    }
    values.set_milli(Id::spread_cycle, static_cast<std::int32_t>(random() % 16) * 1000);
    DriveRig rig(values);
    // What drives had before is not what is asked for: from another firmware.
    for (sim::Tmc2209& drive : rig.uart.wire.drives) {
      drive.write(0x00, static_cast<std::uint32_t>(random()));
      drive.write(0x6c, static_cast<std::uint32_t>(random()));
      drive.write(0x10, static_cast<std::uint32_t>(random()));
      drive.write(0x22, static_cast<std::uint32_t>(random()));
    }
    const unsigned mean_bytes = 20u << random() % 6;
    const unsigned kinds = ++rigs % 2 == 0 ? 6 : 5;
    rig.uart.fault = [&](int& heard, std::uint8_t& sent, bool& is_lost) {
      if (random() % mean_bytes != 0) return;
      ++faults;
      const auto noise = static_cast<std::uint8_t>(1 + random() % 255);
      switch (random() % kinds) {
        case 0:  // on the whole wire
          heard ^= noise;
          sent ^= noise;
          break;
        case 1:  // at the drives only
          sent ^= noise;
          break;
        case 2:
          heard ^= noise;
          break;
        case 3:
          is_lost = true;
          break;
        case 4:
          heard |= 0x100;  // an error of the frame
          break;
        default:
          // A drive loses its supply for a moment. If that is after its last check it is seen by
          // the watch.
          rig.uart.wire.drives[random() % 4].power_up();
          rig.excused_until_us = rig.uart.now_us + 500'000;
      }
    };
    rig.run(1'500'000);
    if (rig.setup.ready()) ++readies;
    rig.uart.fault = nullptr;
    rig.run(1'500'000);
    EXPECT_TRUE(rig.setup.ready());
    EXPECT_EQ(rig.unknown, 0u);
  }
  EXPECT_GE(faults, wanted);
  RecordProperty("faults", static_cast<int>(faults));
  EXPECT_GT(readies, 0u) << "some survive the faults";
}

}  // namespace
}  // namespace lamplock::test
