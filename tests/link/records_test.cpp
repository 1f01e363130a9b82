// Records: round trips, bytes per point, and decoding of whole frames or nothing.
#include "shared/wire/records.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "firmware/program/pulse_decoder.hpp"
#include "host/job/job.hpp"
#include "shared/wire/framing.hpp"
#include "shared/wire/messages.hpp"
#include "tests/link/random_job.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using motion::PointQueue;
using program::PulseDecoder;
using test::random_job;
using test::same;
using wire::Record;

constexpr std::int32_t int_min = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t int_max = std::numeric_limits<std::int32_t>::max();
const StepLimits everywhere{{int_min, int_min, int_min, int_min},
                            {int_max, int_max, int_max, int_max}};

/// Random fields over their whole range, normalised as in the encoding: a pass has no channel or
/// energy.
Record random_record(int axes) {
  Record record;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i)
    record.steps[i] = *rc::gen::oneOf(rc::gen::inRange(-200, 200), rc::gen::inRange(-40000, 40000),
                                      rc::gen::inRange(-(1 << 30), 1 << 30));
  record.beats = *rc::gen::element<std::uint16_t>(0, 0, 0, 1, 300, 65535);
  record.shots = *rc::gen::element<std::uint8_t>(1, 1, 1, 0, 255);
  if (record.shots != 0) {
    record.channel = *rc::gen::inRange<std::uint8_t>(0, 4);
    record.energy = *rc::gen::arbitrary<std::uint16_t>();
  }
  return record;
}

RC_GTEST_PROP(Records, RoundTrip, ()) {
  const int axes = *rc::gen::inRange(1, 5);
  const auto count = *rc::gen::inRange<std::size_t>(0, 60);
  std::vector<Record> records;
  for (std::size_t i = 0; i < count; ++i) records.push_back(random_record(axes));
  std::vector<std::uint8_t> bytes(count * wire::max_record_size);
  wire::ByteWriter out(bytes);
  wire::RecordState writing;
  for (const Record& record : records) RC_ASSERT(wire::put_record(out, writing, record, axes));
  std::vector<Record> read;
  wire::RecordState reading;
  const Result result = wire::walk_records(out.written(), axes, reading, [&](const Record& r) {
    read.push_back(r);
    return Result::ok;
  });
  RC_ASSERT(result == Result::ok);
  RC_ASSERT(read == records);
}

TEST(Records, WriterRefusesWhatCannotBeEncoded) {
  std::array<std::uint8_t, 64> bytes{};
  wire::ByteWriter out(bytes);
  wire::RecordState state;
  state.steps[0] = int_min;
  EXPECT_FALSE(wire::put_record(out, state, Record{{int_max, 0, 0, 0}}, 3));
  EXPECT_FALSE(wire::put_record(out, state, Record{{int_min, 0, 0, 1}}, 3));
  EXPECT_EQ(out.size(), 0u);
  EXPECT_TRUE(wire::put_record(out, state, Record{{-1, 0, 0, 0}}, 3));
}

TEST(Records, ExtremeDeltasNeverWrap) {
  constexpr std::array<std::uint8_t, 5> max_delta{0x03, 0xFF, 0xFF, 0xFF, 0x7F};
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 3; ++i) {
    for (const std::uint8_t byte : max_delta) bytes.push_back(byte);
  }
  PulseDecoder decoder;
  auto queue = std::make_unique<PointQueue>();
  wire::JobHeader header;
  header.points_total = 10;
  decoder.begin(header);
  EXPECT_EQ(decoder.decode(bytes, *queue, everywhere), Result::out_of_bounds);
  EXPECT_EQ(decoder.refused_index(), 1u);
  EXPECT_EQ(queue->size(), 0u);
}

/// Step lengths of a cloud for glass: 45..1000 um between points, at 200 steps/mm, any direction.
TEST(Records, ATypicalPointCostsAtMostEightBytesOnTheWire) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<> length_mm(0.045, 1.0);
  std::normal_distribution<> direction;
  constexpr double steps_per_mm = 200;
  job::Job job;
  StepPosition at{};
  const std::size_t points = 20'000;
  for (std::size_t i = 0; i < points; ++i) {
    std::array<double, 3> d{direction(random), direction(random), direction(random)};
    const double scale = length_mm(random) * steps_per_mm / std::hypot(d[0], d[1], d[2]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis] += static_cast<std::int32_t>(std::lround(d[axis] * scale));
    job.targets.push_back({at, 0, 1, 0, 0});
  }
  std::size_t bytes = 0;
  std::uint32_t number = 0;
  job::RecordEncoder encoder(job, 0);
  for (auto payload = encoder.next(wire::max_payload, 64); !payload.empty();
       payload = encoder.next(wire::max_payload, 64)) {
    std::array<std::uint8_t, wire::max_content> content{};
    wire::ByteWriter out(content);
    wire::write_header(out, {wire::FrameType::data, 0x9A3F7E21u, ++number});
    out.put_bytes(payload);
    std::array<std::uint8_t, wire::max_frame> frame{};
    bytes += wire::encode_frame(out.written(), frame);
  }
  const double cost = static_cast<double>(bytes) / static_cast<double>(points);
  RecordProperty("bytes_per_point", std::to_string(cost));
  EXPECT_LT(cost, 6.0);
  EXPECT_GT(cost, 4.0) << "three deltas and a head need more: the count is wrong";
}

/// Decodes a job payload by payload from `first` on.
void decode_from(const job::Job& job, std::size_t first, std::size_t max_points) {
  PulseDecoder decoder;
  auto queue = std::make_unique<PointQueue>();
  decoder.begin(job::header_from(job, first));
  queue->reset(static_cast<std::uint32_t>(first));
  job::RecordEncoder encoder(job, first);
  std::size_t next = first;
  for (auto payload = encoder.next(wire::max_payload, max_points); !payload.empty();
       payload = encoder.next(wire::max_payload, max_points)) {
    ASSERT_LE(payload.size(), wire::max_payload);
    ASSERT_EQ(decoder.decode(payload, *queue, everywhere), Result::ok);
    for (; next < queue->end(); ++next) {
      ASSERT_TRUE(same(queue->at(static_cast<std::uint32_t>(next)), job.targets[next])) << next;
      for (int i = 0; i < std::max<int>(1, job.targets[next].shots); ++i)
        queue->mark_done(static_cast<std::uint32_t>(next));
    }
  }
  EXPECT_EQ(next, job.targets.size());
}

TEST(PulseDecoder, ReturnsTheJobFromAnyStart) {
  for (int seed = 0; seed < test::scaled(20); ++seed) {
    const job::Job job = random_job(400, static_cast<std::uint64_t>(seed));
    for (const std::size_t first : {0u, 1u, 57u, 399u, 400u}) decode_from(job, first, 64);
    decode_from(job, 0, 1);
    decode_from(job, 0, 1000);
  }
}

/// A decoder with a queue and a good payload.
struct Bench {
  explicit Bench(std::size_t points = 40) : job(random_job(points, 5)) {
    decoder.begin(job.header);
    payload = job::RecordEncoder(job, 0).next(wire::max_payload, points);
  }
  Result decode(std::span<const std::uint8_t> bytes) {
    return decoder.decode(bytes, *queue, limits);
  }
  job::Job job;
  PulseDecoder decoder;
  std::unique_ptr<PointQueue> queue = std::make_unique<PointQueue>();
  StepLimits limits = everywhere;
  std::vector<std::uint8_t> payload;
};

/// A target with several flashes leaves the queue with its last flash, and no other target does.
TEST(PointQueue, FlashesAreCountedOneByOne) {
  auto queue = std::make_unique<PointQueue>();
  queue->reset(7);
  for (const int shots : {1, 3, 0, 255})
    queue->push({{}, 0, static_cast<std::uint8_t>(shots), 0, 0});
  queue->mark_done(8);  // not the next point
  EXPECT_EQ(queue->left(8), 3u);
  std::uint32_t point = 7;
  for (const std::uint32_t flashes : {1u, 3u, 1u, 255u}) {
    for (std::uint32_t left = flashes; left > 0; --left) {
      ASSERT_EQ(queue->begin(), point);
      ASSERT_EQ(queue->left(point), left);
      queue->mark_done(point - 1);  // already done
      queue->mark_done(point);
    }
    ++point;
  }
  EXPECT_EQ(queue->size(), 0u);
  queue->mark_done(point);
  EXPECT_EQ(queue->begin(), point);
}

TEST(PulseDecoder, ADwellIsATargetAtTheSamePlaceWithBeatsAndNoShot) {
  PulseDecoder decoder;
  auto queue = std::make_unique<PointQueue>();
  wire::JobHeader header;
  header.points_total = 10;
  decoder.begin(header);
  // Point, dwell, move of zero length with and without beats; a new frame; dwell.
  const std::vector<std::uint8_t> first{0x01, 5, 0xC2, 9, 0, 0x40, 0xC1, 3, 0, 0x40};
  const std::vector<std::uint8_t> second{0xC2, 1, 0, 0x41, 2, 0x00};
  ASSERT_EQ(decoder.decode(first, *queue, everywhere), Result::ok);
  ASSERT_EQ(decoder.decode(second, *queue, everywhere), Result::ok);
  std::vector<bool> dwells;
  for (std::uint32_t i = 0; i < queue->end(); ++i) dwells.push_back(queue->at(i).dwell);
  EXPECT_EQ(dwells, (std::vector<bool>{false, true, false, true, true, false, false}));
  EXPECT_EQ(queue->at(1).beats, 9);
}

TEST(PulseDecoder, OutOfBoundsNamesThePointAndPushesNothing) {
  Bench bench;
  const std::uint32_t wrong = 23;
  const std::int32_t x = 20000;
  bench.job.targets[wrong].steps[0] = x;
  bench.payload = job::RecordEncoder(bench.job, 0).next(wire::max_payload, 40);
  bench.limits.max[0] = x - 1;
  EXPECT_EQ(bench.decode(bench.payload), Result::out_of_bounds);
  EXPECT_EQ(bench.decoder.refused_index(), wrong);
  EXPECT_EQ(bench.queue->size(), 0u);
  // The limit itself is allowed, and the refusal had no side effect.
  bench.limits.max[0] = x;
  EXPECT_EQ(bench.decode(bench.payload), Result::ok);
  EXPECT_EQ(bench.queue->size(), 40u);
  EXPECT_TRUE(same(bench.queue->at(39), bench.job.targets[39]));
}

TEST(PulseDecoder, AFullQueueAcceptsNothingOfTheFrame) {
  Bench bench;
  bench.queue->reset(0);
  while (bench.queue->free() > 39) bench.queue->push({});
  bench.job.header.points_total = 5000;
  bench.decoder.begin(bench.job.header);
  const std::uint32_t end = bench.queue->end();
  EXPECT_EQ(bench.decode(bench.payload), Result::no_space);
  EXPECT_EQ(bench.queue->end(), end);
  bench.queue->mark_done(0);
  EXPECT_EQ(bench.decode(bench.payload), Result::ok);
  EXPECT_EQ(bench.queue->free(), 0u);
  EXPECT_TRUE(same(bench.queue->at(end + 39), bench.job.targets[39]));
}

TEST(PulseDecoder, MorePointsThanAnnouncedAreRefused) {
  Bench bench;
  bench.job.header.points_total = 39;
  bench.decoder.begin(bench.job.header);
  EXPECT_EQ(bench.decode(bench.payload), Result::bad_value);
  EXPECT_EQ(bench.queue->size(), 0u);
}

TEST(PulseDecoder, MalformedRecordsAreRefusedAsAWhole) {
  const std::vector<std::uint8_t> good{0x15, 1, 2, 3};
  for (const std::vector<std::uint8_t>& bad : {std::vector<std::uint8_t>{0x80},
                                               {0xBF},
                                               {0xC3},
                                               {0xFF},
                                               {0x15, 1, 2},
                                               {0x03, 1, 2, 3},
                                               {0xC0, 0, 1, 0},
                                               {0xC1, 0},
                                               {0xC2, 1}}) {
    Bench bench;
    auto bytes = good;
    bytes.insert(bytes.end(), bad.begin(), bad.end());
    EXPECT_EQ(bench.decode(bytes), Result::bad_frame);
    EXPECT_EQ(bench.queue->size(), 0u);
  }
  for (const std::vector<std::uint8_t>& bad :
       {std::vector<std::uint8_t>{0xC0, 4, 1, 0, 0}, {0xC0, 0, 0, 0, 0}, {0xC2, 0, 0}}) {
    Bench bench;
    EXPECT_EQ(bench.decode(bad), Result::bad_value);
  }
}

TEST(PulseDecoder, AxesTheMachineLacksMustNotMove) {
  Bench bench;
  bench.job.header.axes = 2;
  bench.decoder.begin(bench.job.header);
  EXPECT_EQ(bench.decode(std::vector<std::uint8_t>{0x15, 1, 2, 3}), Result::bad_frame);
  EXPECT_EQ(bench.decode(std::vector<std::uint8_t>{0x05, 1, 2}), Result::ok);
  bench.job.header.axes = 4;
  bench.decoder.begin(bench.job.header);
  EXPECT_EQ(bench.decode(std::vector<std::uint8_t>{0x00, 0x01, 9}), Result::bad_frame);
  EXPECT_EQ(bench.decode(std::vector<std::uint8_t>{0x00, 0x41, 9}), Result::ok);
  EXPECT_EQ(bench.queue->at(1).steps[3], 9);
}

/// Truncations and random bytes: never a crash, never a part of a frame.
TEST(PulseDecoder, GarbageIsAcceptedAsAWholeOrNotAtAll) {
  std::mt19937_64 random(8);
  for (int i = 0; i < test::scaled(2000); ++i) {
    Bench bench;
    auto bytes = bench.payload;
    if (i % 2 == 0) bytes.resize(random() % bytes.size());
    for (int k = 0; k < i % 5; ++k)
      if (!bytes.empty()) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    const Result result = bench.decode(bytes);
    if (result != Result::ok) {
      ASSERT_EQ(bench.queue->size(), 0u);
    }
    ASSERT_LE(bench.queue->size(), 40u);
  }
}

}  // namespace
}  // namespace lamplock
