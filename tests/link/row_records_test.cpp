// Records of rows: round trips, golden bytes, and refusals.
#include "shared/wire/row_records.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "shared/wire/messages.hpp"
#include "tests/scale.hpp"

namespace lamplock::wire {
namespace {

/// A line and its runs.
struct Row {
  RowLine line;
  std::vector<std::uint16_t> runs;
  friend bool operator==(const Row&, const Row&) = default;
};

using Frames = std::vector<std::vector<std::uint8_t>>;

/// Lines of any length and kind; none ends where the preceding one ends.
std::vector<Row> random_rows(std::mt19937_64& random, int axes, int count) {
  std::vector<Row> rows;
  StepPosition at{};
  for (int i = 0; i < count; ++i) {
    Row row;
    const std::int32_t most = random() % 3 == 0 ? 100 : random() % 2 == 0 ? 30'000 : 1 << 24;
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(axes); ++axis)
      at[axis] += static_cast<std::int32_t>(random() % static_cast<unsigned>(most)) - most / 2;
    at[0] += i % 2 == 0 ? 2 * most : -2 * most;
    row.line.steps = at;
    row.line.light = random() % 4 != 0;
    std::uint32_t cells = 0;
    for (auto n = row.line.light ? 1 + random() % max_runs_a_line : 0; n != 0; --n) {
      const auto run = max_run(static_cast<std::uint16_t>(random()),
                               1 + static_cast<std::uint32_t>(random() % 200));
      if (cells + run_cells(run) > max_cells_a_line) break;
      cells += run_cells(run);
      row.runs.push_back(run);
    }
    if (row.line.light) row.line.feed_milli = random() % 3 == 0 ? 6'000'000 : 12'345;
    rows.push_back(row);
  }
  return rows;
}

/// Encodes rows into frames of random sizes.
Frames encoded(const std::vector<Row>& rows, int axes, std::mt19937_64& random) {
  Frames frames;
  std::vector<std::uint8_t> bytes(max_payload);
  std::size_t room = 0;
  ByteWriter out({});
  const auto next_frame = [&] {
    if (room != 0) frames.emplace_back(out.written().begin(), out.written().end());
    room = 2 * max_row_line_size + random() % (max_payload - 2 * max_row_line_size);
    out = ByteWriter(std::span(bytes).first(room));
  };
  next_frame();
  RowState state;
  for (const Row& row : rows) {
    std::span<const std::uint16_t> left(row.runs);
    while (!left.empty()) {
      left = left.subspan(put_runs(out, state, left));
      if (!left.empty() && out.room() < max_row_line_size) next_frame();
    }
    while (!put_row_line(out, state, row.line, axes)) next_frame();
  }
  next_frame();
  return frames;
}

Result walk(const Frames& frames, int axes, std::vector<Row>& rows) {
  RowState state;
  Row row;
  for (const auto& frame : frames) {
    const Result result = walk_row_records(
        frame, axes, state,
        [&](const RowLine& line) {
          row.line = line;
          rows.push_back(std::exchange(row, Row{}));
          return Result::ok;
        },
        [&](std::uint16_t run) {
          row.runs.push_back(run);
          return Result::ok;
        });
    if (result != Result::ok) return result;
  }
  return Result::ok;
}

Result walk(const std::vector<std::uint8_t>& bytes, int axes = 3) {
  std::vector<Row> rows;
  return walk(Frames{bytes}, axes, rows);
}

TEST(RowRecords, RoundTrip) {
  std::mt19937_64 random(11);
  for (int i = 0; i < test::scaled(300); ++i) {
    const int axes = 1 + static_cast<int>(random() % 4);
    const auto rows = random_rows(random, axes, static_cast<int>(random() % 20));
    std::vector<Row> read;
    ASSERT_EQ(walk(encoded(rows, axes, random), axes, read), Result::ok);
    ASSERT_TRUE(read == rows) << i;
  }
}

TEST(RowRecords, HaveTheseBytes) {
  std::array<std::uint8_t, 64> bytes{};
  ByteWriter out(bytes);
  RowState state;
  ASSERT_TRUE(put_row_line(out, state, {{-2, 300, 0, 0}, false, 0}, 3));
  const std::array<std::uint16_t, 3> runs{max_run(65535, 1), max_run(0, 100), max_run(32768, 16)};
  ASSERT_EQ(put_runs(out, state, runs), 3u);
  ASSERT_TRUE(put_row_line(out, state, {{98, 300, 0, 0}, true, 6'000'000}, 3));
  ASSERT_EQ(put_runs(out, state, std::span(runs).first(1)), 1u);
  ASSERT_TRUE(put_row_line(out, state, {{-2, 300, 0, 0}, true, 6'000'000}, 3));
  const std::vector<std::uint8_t> golden{
      0x49, 0xFE, 0x2C, 0x01,                          // rapid: x -2, y +300
      0xC4, 3,    0xE0, 0xFF, 0x11, 0x00, 0x0F, 0x80,  // one full, 64 (of 100) dark, 16 at half
      0xC3, 0x80, 0x8D, 0x5B, 0x00, 0x01, 0x64,        // feed, line: x +100
      0xC4, 1,    0xE0, 0xFF, 0x01, 0x9C};             // the same run; x -100
  EXPECT_EQ(std::vector<std::uint8_t>(out.written().begin(), out.written().end()), golden);
}

/// Splitting into longest runs gives the fewest runs, keeps the total length and the power.
TEST(Runs, AreTheFewestForTheirLengthAndKeepThePower) {
  for (std::uint32_t cells = 1; cells <= 0x10000; cells += cells < 300 ? 1 : 37) {
    std::uint32_t left = cells, count = 0;
    for (; left != 0; ++count) {
      const std::uint16_t run = max_run(40'000, left);
      ASSERT_LE(run_cells(run), left);
      if (left >= 32) {
        ASSERT_GT(2 * run_cells(run), left);
      } else if (left > 16) {
        ASSERT_EQ(run_cells(run), 16u);
      } else {
        ASSERT_EQ(run_cells(run), left);
      }
      left -= run_cells(run);
    }
    ASSERT_EQ(count, runs_of(cells));
  }
  for (std::uint32_t power = 0; power <= 65'535; ++power) {
    const auto p = static_cast<std::uint16_t>(power);
    ASSERT_NEAR(run_power(max_run(p, 1)), p, 17);
    ASSERT_EQ(max_run(run_power(max_run(p, 7)), 7), max_run(p, 7));
  }
  EXPECT_EQ(run_power(0xffff), 65'535);
  EXPECT_EQ(run_power(0x001f), 0);
}

TEST(RowRecords, WriterRefusesWhatCannotBeEncoded) {
  std::array<std::uint8_t, 2000> bytes{};
  ByteWriter out(bytes);
  RowState state;
  EXPECT_FALSE(put_row_line(out, state, {{1, 0, 0, 0}, true, 100}, 3)) << "without runs";
  EXPECT_FALSE(put_row_line(out, state, {{0, 0, 0, 1}, false, 0}, 3))
      << "the machine has no such axis";
  EXPECT_EQ(out.size(), 0u);
  const std::vector<std::uint16_t> runs(600, max_run(1, 1));
  EXPECT_EQ(put_runs(out, state, runs), max_runs_a_record);
  EXPECT_EQ(put_runs(out, state, runs), max_runs_a_record);
  EXPECT_EQ(put_runs(out, state, runs), max_runs_a_line - 2 * max_runs_a_record);
  EXPECT_EQ(put_runs(out, state, runs), 0u);
  EXPECT_FALSE(put_row_line(out, state, {{1, 0, 0, 0}, false, 0}, 3)) << "dark, with runs";
  EXPECT_FALSE(put_row_line(out, state, {{1, 0, 0, 0}, true, 0}, 3)) << "without feed";
  EXPECT_FALSE(put_row_line(out, state, {{}, true, 1}, 3)) << "no motion";
  EXPECT_TRUE(put_row_line(out, state, {{1, 0, 0, 0}, true, 1}, 3));
  const std::array<std::uint16_t, 2> long_runs{max_run(1, 32'768), max_run(1, 32'768)};
  EXPECT_EQ(put_runs(out, state, long_runs), 1u) << "the runs have more cells than a line may have";
  std::array<std::uint8_t, 7> few{};
  ByteWriter small(few);
  RowState fresh;
  EXPECT_EQ(put_runs(small, fresh, runs), 2u);
  EXPECT_FALSE(put_row_line(small, fresh, {{1, 0, 0, 0}, true, 1}, 3));
  EXPECT_EQ(fresh.runs, 2u);
}

TEST(RowRecords, MalformedRecordsAreRefused) {
  const std::vector<std::uint8_t> feed{0xC3, 1, 0, 0, 0};
  const std::vector<std::uint8_t> run{0xC4, 1, 0xE0, 0xFF};
  const auto after = [](std::vector<std::uint8_t> first, std::vector<std::uint8_t> then) {
    first.insert(first.end(), then.begin(), then.end());
    return walk(first);
  };
  EXPECT_EQ(after(feed, run), Result::ok);
  for (const std::vector<std::uint8_t>& bad : {std::vector<std::uint8_t>{0x80},
                                               {0xC0, 0, 1, 0, 0},
                                               {0xC1, 1, 0},
                                               {0xC2, 1, 0},
                                               {0xC5},
                                               {0xFF},
                                               {0xC3, 1, 0, 0},
                                               {0xC4},
                                               {0xC4, 2, 0, 0, 0},
                                               {0x41},
                                               {0x03, 1, 2, 3}})
    EXPECT_EQ(after(feed, bad), Result::bad_frame);
  EXPECT_EQ(walk({0xC3, 0, 0, 0, 0}), Result::bad_value);
  EXPECT_EQ(walk({0xC4, 0}), Result::bad_value);
  EXPECT_EQ(after(feed, {0x01, 5}), Result::bad_value) << "light without runs";
  EXPECT_EQ(after(run, {0x01, 5}), Result::bad_value) << "light without feed";
  EXPECT_EQ(after(run, {0x41, 5}), Result::bad_value) << "a rapid with runs";
  EXPECT_EQ(walk({0x40}), Result::ok) << "a rapid to its current position";
  EXPECT_EQ(walk({0xC3, 1, 0, 0, 0, 0xC4, 1, 0, 0, 0x00}), Result::bad_value) << "no motion";
  EXPECT_EQ(walk({0x43, 0xFF, 0xFF, 0xFF, 0x7F, 0x41, 1}), Result::out_of_bounds);
  std::vector<std::uint8_t> many{0xC4, 201};
  many.resize(2 + 201 * 2, 0);
  EXPECT_EQ(walk(many), Result::bad_value);
  // The longest run is longer than any line.
  EXPECT_EQ(walk({0xC4, 1, 0x1F, 0}), Result::bad_value);
  EXPECT_EQ(walk({0xC4, 2, 0x1A, 0, 0x1A, 0}), Result::bad_value);
}

TEST(RowRecords, ALineHasAtMostTheMaximumOfRuns) {
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t runs = 0; runs < max_runs_a_line; ++runs)
    bytes.insert(bytes.end(), {head_runs, 1, 0, 0});
  EXPECT_EQ(walk(bytes), Result::ok);
  bytes.insert(bytes.end(), {head_runs, 1, 0, 0});
  EXPECT_EQ(walk(bytes), Result::bad_value);
}

/// Every pixel has another power, in rows of 500.
TEST(RowRecords, AGreyPixelCostsLessThanThreeBytesOnTheWire) {
  std::mt19937_64 random(13);
  std::vector<Row> rows;
  constexpr int count = 200, pixels = 500;
  for (int i = 0; i < count; ++i) {
    Row row{{{i % 2 == 0 ? 10'000 : 0, 20 * i, 0, 0}, true, 18'000'000}, {}};
    for (int k = 0; k < pixels; ++k)
      row.runs.push_back(max_run(static_cast<std::uint16_t>(random()), 1));
    rows.push_back(row);
  }
  std::size_t bytes = 0;
  std::uint32_t number = 0;
  std::array<std::uint8_t, max_payload> payload{};
  ByteWriter records(payload);
  const auto send = [&] {
    std::array<std::uint8_t, max_content> content{};
    ByteWriter out(content);
    write_header(out, {FrameType::data, 0x9A3F7E21u, ++number});
    out.put_bytes(records.written());
    std::array<std::uint8_t, max_frame> frame{};
    bytes += encode_frame(out.written(), frame);
    records = ByteWriter(payload);
  };
  RowState state;
  for (const Row& row : rows) {
    for (std::span<const std::uint16_t> left(row.runs); !left.empty();) {
      const std::size_t put = put_runs(records, state, left);
      left = left.subspan(put);
      if (put == 0) send();
    }
    while (!put_row_line(records, state, row.line, 3)) send();
  }
  send();
  const double cost = static_cast<double>(bytes) / (count * pixels);
  RecordProperty("bytes_per_pixel", std::to_string(cost));
  EXPECT_LT(cost, 2.7);
  EXPECT_GT(cost, 2.0) << "two bytes and frames around them: the count is wrong";
}

/// Random bytes cause no crash and no value beyond the limits.
TEST(RowRecords, GarbageKeepsToTheLimits) {
  std::mt19937_64 random(12);
  for (int i = 0; i < test::scaled(3000); ++i) {
    const int axes = 1 + static_cast<int>(random() % 4);
    auto frames = encoded(random_rows(random, axes, 4), axes, random);
    for (auto& frame : frames) {
      for (auto k = random() % 4; k != 0 && !frame.empty(); --k)
        frame[random() % frame.size()] = static_cast<std::uint8_t>(random());
      if (random() % 8 == 0) frame.resize(random() % (frame.size() + 1));
    }
    std::vector<Row> rows;
    walk(frames, axes, rows);
    for (const Row& row : rows) {
      std::uint32_t cells = 0;
      for (const std::uint16_t run : row.runs) cells += run_cells(run);
      ASSERT_LE(row.runs.size(), max_runs_a_line);
      ASSERT_LE(cells, max_cells_a_line);
      ASSERT_EQ(row.line.light, cells != 0);
      ASSERT_TRUE(!row.line.light || row.line.feed_milli != 0);
    }
  }
}

}  // namespace
}  // namespace lamplock::wire
