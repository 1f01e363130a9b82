// Layouts: written data are read back, and the offsets equal those of the document.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "shared/wire/job_header.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::wire {
namespace {

template <class Number>
void expect_round_trip(Number value) {
  std::array<std::uint8_t, sizeof(Number)> bytes{};
  ByteWriter out(bytes);
  out.put(value);
  ByteReader in(out.written());
  RC_ASSERT(in.take<Number>() == value);
  RC_ASSERT(in.exhausted());
}

RC_GTEST_PROP(Bytes, RoundTrip,
              (std::int8_t a, std::int16_t b, std::int32_t c, std::uint32_t d, std::uint16_t e)) {
  expect_round_trip(a);
  expect_round_trip(b);
  expect_round_trip(c);
  expect_round_trip(d);
  expect_round_trip(e);
}

TEST(Bytes, AreLittleEndianAndStopAtTheEnd) {
  std::array<std::uint8_t, 5> bytes{};
  ByteWriter out(bytes);
  out.put(std::uint32_t{0x01020304});
  out.put(std::uint32_t{5});
  EXPECT_FALSE(out.ok());
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 5>{4, 3, 2, 1, 0}));
  ByteReader in(out.written());
  in.take<std::uint16_t>();
  EXPECT_EQ(in.take<std::uint32_t>(), 0u);
  EXPECT_FALSE(in.ok());
}

JobHeader sample_header() {
  JobHeader header;
  header.axes = 4;
  header.mode = 2;
  header.dry = true;
  header.points_total = 0x01020304;
  header.first_index = 17;
  header.settings_hash = 0xDEADBEEF;
  header.origin_steps = {-1, 2, -300000, 400000};
  header.overrides[0] = {901, 100'000};
  header.overrides[1] = {940, -50'000};
  header.override_count = 2;
  return header;
}

std::vector<std::uint8_t> written(const JobHeader& header) {
  std::vector<std::uint8_t> bytes(max_job_header_size);
  ByteWriter out(bytes);
  write_job_header(out, header);
  bytes.resize(out.size());
  return bytes;
}

TEST(JobHeader, RoundTrip) {
  const auto bytes = written(sample_header());
  EXPECT_EQ(bytes.size(), 34u + 2 * 6u);
  EXPECT_EQ(bytes[6], 4);    // points in the job
  EXPECT_EQ(bytes[10], 17);  // first index
  EXPECT_EQ(bytes[18], 0xFF);
  JobHeader header;
  ASSERT_EQ(read_job_header(bytes, header), Result::ok);
  EXPECT_EQ(header, sample_header());
}

TEST(JobHeader, BadHeadersAreRefusedAndChangeNothing) {
  const auto good = written(sample_header());
  JobHeader header;
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_EQ(read_job_header(std::span(good).first(size), header), Result::bad_frame);
  auto other_version = good;
  other_version[0] = protocol_version + 1;
  EXPECT_EQ(read_job_header(other_version, header), Result::bad_version);
  for (const auto& [offset, value] :
       {std::pair{2, 0}, {2, 5}, {3, 4}, {4, 2}, {13, 0x10}}) {  // axes, mode, flags, first > total
    auto bad = good;
    bad[static_cast<std::size_t>(offset)] = static_cast<std::uint8_t>(value);
    EXPECT_EQ(read_job_header(bad, header), Result::bad_value) << offset;
  }
  EXPECT_EQ(header, JobHeader{});
}

TEST(Status, RoundTripAndSize) {
  Status status;
  status.session = 0x11223344;
  status.number = 99;
  status.state = MachineState::hold;
  status.hold_reason = HoldReason::dead_man;
  status.alarm = 3;
  status.lamp_locked = true;
  std::uint32_t value = 1000;
  for (auto* field :
       {&status.next_number, &status.echo, &status.last_command, &status.free_points,
        &status.received, &status.first_unfired, &status.shots, &status.beats, &status.beats_before,
        &status.starvations, &status.shots_made, &status.shots_not_made, &status.repeats,
        &status.link.bad_frames, &status.link.duplicates, &status.link.out_of_order,
        &status.link.lost_lines, &status.link.transmit_overflows, &status.free_runs})
    *field = value++;
  for (auto& beats : status.beats_by_reason) beats = value++;
  for (auto& beats : status.beats_outside) beats = value++;
  std::array<std::uint8_t, 300> bytes{};
  ByteWriter out(bytes);
  write_status(out, status);
  ASSERT_EQ(out.size(), status_size);
  Status read;
  ASSERT_TRUE(read_status({FrameType::status, 0x11223344, 99}, out.written(), read));
  EXPECT_EQ(read, status);
  for (std::size_t size = 0; size < status_size; ++size)
    EXPECT_FALSE(read_status({}, std::span(bytes).first(size), read));
}

TEST(Status, OfAnotherVersionGivesItsVersion) {
  const std::array<std::uint8_t, 3> bytes{9, 0, 77};
  Status status;
  ASSERT_TRUE(read_status({}, bytes, status));
  EXPECT_EQ(status.version, 9);
}

}  // namespace
}  // namespace lamplock::wire
