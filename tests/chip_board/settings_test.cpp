// Settings are written at rest only, whatever a host sends after them without waiting.
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// BEGIN and all points of a short job, at once.
void send_job(ChipRig& rig, const job::Job& job, std::uint32_t session) {
  ChipCable cable(rig);
  link::Connection connection(cable);
  std::array<std::uint8_t, wire::max_job_header_size> header{};
  wire::ByteWriter out(header);
  wire::write_job_header(out, job::header_from(job, 0));
  connection.send({wire::FrameType::begin, session, 0}, out.written());
  job::RecordEncoder encoder(job, 0);
  connection.send({wire::FrameType::data, session, 1},
                  encoder.next(wire::max_payload, job.targets.size()));
  connection.flush();
}

TEST(Settings, NoneAreWrittenWhileTheMachineMoves) {
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  rig.run(100 * ps_per_ms);  // until the clock follows the lamp
  sim::chip::FlashChip& flash = rig.board.chip().flash();
  const job::Job job = job::make_job(chip_points(3, 1), profile, {});
  int erased = 0;
  // A sector holds sixteen records: in one of the rounds the second record waits for an erase.
  for (std::uint32_t round = 1; round <= 9; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const std::size_t shots = rig.shots().size();
    rig.type("$21=0\n");
    const Picoseconds limit = rig.now() + 5 * ps_per_ms;
    while (!flash.busy(rig.now()) && rig.now() < limit) rig.run(10 * ps_per_us);
    ASSERT_TRUE(flash.busy(rig.now()));
    // The job arrives during the write: all of it is there when the board returns.
    rig.type("$21=1\n");
    send_job(rig, job, round);
    const Picoseconds end = rig.now() + 120 * ps_per_ms;
    while (rig.now() < end) {
      const bool busy = flash.busy(rig.now());
      const Picoseconds from = rig.now();
      if (busy && flash.busy_until() - from > 10 * ps_per_ms) ++erased;
      rig.run(100 * ps_per_us);
      if (busy) {
        ASSERT_LT(rig.last_step(), from) << "flash busy, machine moving";
      }
    }
    ASSERT_EQ(rig.shots().size(), shots + job.targets.size());
  }
  EXPECT_GT(erased, 0);
}

}  // namespace
}  // namespace lamplock::test
