// The pulse stream's own USB interface: a job over it is the same as over the serial port, whatever
// arrives at the serial port; the dead man's timeout, the cable and the requests of Windows.
#include <algorithm>

#include "tests/chip_board/cable_trouble.hpp"

namespace lamplock::test {
namespace {

using sim::chip::UsbFunction;

/// A booted rig that uses one of the functions.
struct FunctionRig : ChipRig {
  FunctionRig(const job::Profile& profile, UsbFunction function) : ChipRig(profile) {
    board.talk_over(function);
  }
  sim::chip::UsbHost& host() { return board.usb_host(); }
  /// Opens both functions, whichever the rig uses.
  void open_both() {
    host().open_serial(true);
    host().claim_vendor(true);
  }
  void send_beside(std::string_view text, UsbFunction function) {
    host().write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, function);
  }
  std::string heard_beside(UsbFunction function) {
    std::array<std::uint8_t, 4096> bytes;
    const std::size_t count = host().read(bytes, function);
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count)};
  }
};

/// Results of a job: every shot's place and beat from the first one on, every step.
struct Deeds {
  std::vector<std::tuple<std::int64_t, StepPosition>> shots;
  std::vector<Step> steps;
  bool operator==(const Deeds&) const = default;
};

Deeds deeds_of(const ChipRig& rig) {
  Deeds deeds;
  for (const auto& shot : rig.shots())
    deeds.shots.emplace_back(static_cast<std::int64_t>(shot.beat - rig.shots().front().beat),
                             shot.steps);
  deeds.steps = steps_of(rig.monitor, step_latency);
  return deeds;
}

/// Text from programs that is not meant for a working machine: polls, resets, a service that probes
/// for modems, a program line, an incomplete line.
std::string chatter(std::mt19937_64& random) {
  static const std::array<std::string, 8> words{"?",         "!",       "\x18",      "~",
                                                "AT+GCAP\r", "G1 X5\n", "\x7e\x78~", "$110="};
  return words[random() % words.size()];
}

TEST(ChipPulseStream, AJobIsTheSameOverBothFunctions) {
  const job::Profile profile = chip_profile(1000);
  const job::Job job =
      job::make_job(chip_points(static_cast<std::size_t>(scaled(60)), 7), profile, {});
  std::vector<Deeds> deeds;
  for (const UsbFunction function : {UsbFunction::serial, UsbFunction::vendor}) {
    FunctionRig rig(profile, function);
    RunningJob running(rig, job, 1);
    ASSERT_EQ(running.finish(), JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_fired(rig, job));
    deeds.push_back(deeds_of(rig));
  }
  EXPECT_FALSE(deeds[0].steps.empty());
  EXPECT_TRUE(deeds[0] == deeds[1]);
}

// Vice versa: text over the stream's interface during a job over the serial port.
TEST(ChipPulseStream, ChatterOverTheOtherFunctionDisturbsNoJob) {
  const job::Profile profile = chip_profile(1000);
  const job::Job job =
      job::make_job(chip_points(static_cast<std::size_t>(scaled(60)), 8), profile, {});
  for (const UsbFunction function : {UsbFunction::vendor, UsbFunction::serial}) {
    const UsbFunction beside =
        function == UsbFunction::serial ? UsbFunction::vendor : UsbFunction::serial;
    std::vector<Deeds> deeds;
    for (const bool noisy : {false, true}) {
      FunctionRig rig(profile, function);
      std::mt19937_64 random(9);
      RunningJob running(rig, job, 1);
      ASSERT_TRUE(running.run_until_fired(1));
      rig.open_both();
      rig.heard_beside(beside);
      const Picoseconds end = rig.now() + running.limit();
      std::string heard;
      while (running.sender.step() && rig.now() < end) {
        // After its last point the job ends, and the other function is answered.
        if (rig.shots().size() < job.targets.size()) heard += rig.heard_beside(beside);
        if (noisy && rig.host().unsent(beside) < 256) rig.send_beside(chatter(random), beside);
      }
      ASSERT_EQ(running.sender.result().end, JobEnd::done);
      ASSERT_NO_FATAL_FAILURE(expect_fired(rig, job));
      EXPECT_EQ(running.sender.result().resent, 0u);
      EXPECT_EQ(heard, "");
      deeds.push_back(deeds_of(rig));
    }
    EXPECT_TRUE(deeds[0] == deeds[1]);
  }
}

// Its first line is answered, even with a poll in the packet of the line, as senders do it.
TEST(ChipPulseStream, TheSerialPortIsAnsweredASecondAfterTheStream) {
  FunctionRig rig(chip_profile(), UsbFunction::vendor);
  EXPECT_THAT(rig.answer("$I"), HasSubstr("[VER:"));
  rig.open_both();
  rig.heard_beside(UsbFunction::serial);
  rig.send_beside("$I\n?", UsbFunction::serial);
  rig.run(100 * ps_per_ms);
  EXPECT_EQ(rig.heard_beside(UsbFunction::serial), "");
  EXPECT_THAT(rig.answer("$I"), HasSubstr("[VER:"));
  rig.run(1100 * ps_per_ms);
  rig.send_beside("$I\n?", UsbFunction::serial);
  rig.run(100 * ps_per_ms);
  EXPECT_THAT(rig.heard_beside(UsbFunction::serial), HasSubstr("[VER:"));
  EXPECT_THAT(rig.answer("$I"), HasSubstr("[VER:")) << "the stream is never refused at rest";
}

// Another program keeps querying the new device, beginning before the job's host is back.
TEST(ChipPulseStream, PulledAndPluggedInAJobAtRandomMoments) {
  const job::Profile profile = chip_profile();
  FunctionRig rig(profile, UsbFunction::vendor);
  rig.open_both();
  std::mt19937_64 random(16);
  CableCuts cuts{.seed = 15, .first_after_shots = 1, .max_wait = 40 * ps_per_ms};
  cuts.pull = [&rig](int) { rig.host().unplug(); };
  cuts.plug = [&rig] { rig.host().plug(); };
  cuts.beside = [&](ChipCable& cable, Picoseconds back) {
    for (int word = 0; word < 20; ++word)
      cable.at(back + (5 + word) * ps_per_ms,
               [&] { rig.send_beside(chatter(random), UsbFunction::serial); });
  };
  run_jobs_with_cuts(rig, profile, cuts);
}

// That the serial port is heard after ten seconds of silence is tested with the Listener
// (tests/board_rp2040/usb_listener_test.cpp): ten seconds take long on the simulated chip.
TEST(ChipPulseStream, ASilentHostTriggersTheDeadMansTimeout) {
  job::Profile profile = chip_profile();
  profile.settings.set_milli(Id::dead_man, 200'000);  // ms
  FunctionRig rig(profile, UsbFunction::vendor);
  rig.open_both();
  const job::Job job = job::make_job(chip_points(100, 3), profile, {});
  RunningJob running(rig, job, 1);
  ASSERT_TRUE(running.run_until_fired(10));
  // The host program hangs; it has the interface open and does not read.
  const Picoseconds limit = profile.settings.milli(Id::dead_man) * ps_per_us;
  // The machine brakes and is held.
  rig.run(limit + 100 * ps_per_ms);
  const std::size_t fired = rig.shots().size();
  rig.send_beside("?", UsbFunction::serial);
  rig.run(100 * ps_per_ms);
  EXPECT_EQ(rig.heard_beside(UsbFunction::serial), "");
  EXPECT_EQ(rig.shots().size(), fired);
  EXPECT_LT(fired, job.targets.size());
  // The host program continues its job.
  EXPECT_EQ(running.finish(), JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_fired(rig, job));
}

TEST(ChipPulseStream, ABadCableCostsTimeOnly) {
  const job::Profile profile = chip_profile(1000);
  std::uint64_t repeated = 0;
  for (int seed = 0; seed < scaled(2); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    FunctionRig rig(profile, UsbFunction::vendor);
    const job::Job job = job::make_job(chip_points(100, random()), profile, {});
    int faults = 0;
    rig.host().set_fault_injector([&](sim::chip::usb::Transaction& transaction) {
      if (transaction.endpoint != rig.host().vendor().in &&
          transaction.endpoint != rig.host().vendor().out)
        return;
      // Lost and broken packets, lost acknowledgements.
      for (sim::chip::usb::Fault* fault :
           {&transaction.token_fault, &transaction.data_fault, &transaction.handshake_fault}) {
        if (random() % 30 != 0) continue;
        *fault = random() % 2 == 0 ? sim::chip::usb::Fault::lost : sim::chip::usb::Fault::crc;
        ++faults;
      }
    });
    RunningJob running(rig, job, 1);
    ASSERT_EQ(running.finish(), JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_fired(rig, job));
    EXPECT_EQ(running.sender.result().resent, 0u) << "USB itself must retransmit";
    EXPECT_GT(faults, 20);
    repeated += rig.host().statistics().repeated;
  }
  EXPECT_GT(repeated, 0u);
}

TEST(ChipPulseStream, GarbageNeverMovesNorFires) {
  FunctionRig rig(chip_profile(), UsbFunction::vendor);
  rig.open_both();
  std::mt19937_64 random(4);
  std::array<std::uint8_t, 512> bytes;
  for (int i = 0; i < scaled(200); ++i) {
    for (const UsbFunction function : {UsbFunction::serial, UsbFunction::vendor}) {
      fill_with_noise(bytes, random);
      rig.host().write(bytes, function);
    }
    rig.run(ps_per_ms);
    rig.heard_beside(UsbFunction::serial);
    rig.heard_beside(UsbFunction::vendor);
  }
  expect_garbage_did_nothing(rig);
}

TEST(ChipPulseStream, WindowsFindsWinUsb) {
  const job::Profile profile = chip_profile();
  for (const bool second_reset : {false, true}) {
    sim::ChipBoardOptions options = quick_host();
    options.usb.windows = true;
    options.usb.second_reset = second_reset;
    sim::ChipBoard board(flash_image(), profile.settings, world_for(profile), options);
    ASSERT_TRUE(board.run_until_found(1000 * ps_per_ms));
    sim::chip::UsbHost& host = board.usb_host();
    ASSERT_TRUE(host.microsoft_set().has_value());
    EXPECT_EQ(host.microsoft_set()->compatible_id, "WINUSB");
    EXPECT_EQ(host.microsoft_set()->interface, host.vendor().interface);
    ASSERT_EQ(host.microsoft_set()->guids.size(), 1u);
    EXPECT_EQ(host.strings().at(host.vendor().string), "lamplock pulse stream");
    // Older Windows asks when the device is configured.
    host.control({0xc0, 0x4d, 0, 0, 7, 0, 178, 0});
    board.run_until(board.now() + 5 * ps_per_ms);
    EXPECT_EQ(host.last_control().data.size(), 178u);
    EXPECT_THAT(host.violations(), IsEmpty());
    EXPECT_THAT(board.chip().usb().violations(), IsEmpty());
  }
}

}  // namespace
}  // namespace lamplock::test
