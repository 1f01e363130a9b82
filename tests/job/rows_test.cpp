// Rows as records: round trips through frames and files, places of the table, resuming.
#include "host/job/rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "host/error.hpp"
#include "host/job/job_file.hpp"
#include "shared/wire/crc32.hpp"
#include "tests/error_of.hpp"
#include "tests/job/random_rows.hpp"
#include "tests/scale.hpp"

namespace lamplock::job {
namespace {

using test::random_row_job;
using testing::HasSubstr;

/// Rows decoded from payloads, counted like the board does.
struct Decoded {
  Rows rows;
  std::uint64_t places = 0;
  wire::RowState state;

  void take(std::span<const std::uint8_t> payload, int axes) {
    const auto line = [this](const wire::RowLine& to) {
      const std::size_t first =
          rows.lines.empty() ? 0 : rows.lines.back().first_run + rows.lines.back().runs;
      rows.lines.push_back({to, first, rows.runs.size() - first});
      open = false;
      return Result::ok;
    };
    const auto run = [this](std::uint16_t r) {
      places += open ? 1 : 2;
      open = true;
      rows.runs.push_back(r);
      return Result::ok;
    };
    ASSERT_EQ(wire::walk_row_records(payload, axes, state, line, run), Result::ok);
  }

 private:
  bool open = false;  ///< a header for the next line was read
};

TEST(RowEncoder, FramesOfAnySizeGiveTheSameRowsFromAnyLine) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Job job = random_row_job(20 + random() % 100, random());
    const std::size_t first = random() % job.size();
    RecordEncoder encoder(job, first);
    Decoded decoded;
    decoded.state.steps = header_from(job, first).origin_steps;
    for (;;) {
      const std::size_t before = encoder.index(), most = 1 + random() % 16;
      const auto payload =
          encoder.next(wire::max_row_line_size + random() % (wire::max_payload - 22), most);
      if (payload.empty()) break;
      decoded.take(payload, job.header.axes);
      ASSERT_LE(encoder.index() - before, most);
      ASSERT_EQ(encoder.index() - first, decoded.rows.lines.size());
      ASSERT_EQ(encoder.places(), decoded.places);
    }
    ASSERT_EQ(encoder.index(), job.size());
    ASSERT_EQ(decoded.rows.lines.size(), job.size() - first);
    for (std::size_t k = first; k < job.size(); ++k) {
      const Line &wanted = job.rows.lines[k], &got = decoded.rows.lines[k - first];
      ASSERT_EQ(got.to, wanted.to) << k;
      ASSERT_THAT(decoded.rows.runs_of(got), testing::ElementsAreArray(job.rows.runs_of(wanted)));
    }
  }
}

TEST(RowEncoder, LinesThatRecordsCannotEncodeAreErrors) {
  const auto error = [](auto change) {
    Job job = random_row_job(5, 1);
    change(job.rows);
    return test::error_of([&] {
      RecordEncoder encoder(job, 0);
      while (!encoder.next(wire::max_payload, 100).empty()) {
      }
    });
  };
  EXPECT_THAT(error([](Rows& r) { r.lines[3].to.steps = r.lines[2].to.steps; }),
              HasSubstr("line 3"));
  EXPECT_THAT(error([](Rows& r) { r.lines[1].to.steps[3] = 1; }), HasSubstr("line 1"));
  EXPECT_THAT(error([](Rows& r) { r.lines[1].runs = 0; }), HasSubstr("line 1"));
  EXPECT_THAT(error([](Rows& r) { r.lines[1].to.feed_milli = 0; }), HasSubstr("line 1"));
  EXPECT_THAT(error([](Rows& r) {
                r.lines[1].first_run = r.runs.size();
                r.lines[1].runs = wire::max_runs_a_line + 1;
                r.runs.resize(r.runs.size() + r.lines[1].runs);
              }),
              HasSubstr("line 1"));
}

TEST(RowJobFile, AWrittenJobIsReadBack) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Job job = random_row_job(200, seed);
    const Job again = decode_job_file(encode_job_file(job), "rows.llj");
    EXPECT_TRUE(again.is_rows());
    EXPECT_EQ(again.rows, job.rows);
    EXPECT_EQ(again.size(), job.size());
    EXPECT_EQ(again.settings, job.settings);
    wire::JobHeader header = job.header;
    header.settings_hash = job.settings.hash();
    EXPECT_EQ(again.header, header);
  }
}

TEST(RowJobFile, InvalidDataWithAGoodChecksumNeverCausesACrash) {
  const auto good = encode_job_file(random_row_job(40, 2));
  std::mt19937_64 random(2);
  for (int i = 0; i < test::scaled(3000); ++i) {
    auto broken = good;
    for (int n = 0; n < 3; ++n)
      broken[random() % (broken.size() - 4)] = static_cast<std::uint8_t>(random());
    const std::uint32_t crc = wire::crc32(std::span(broken).first(broken.size() - 4));
    for (std::size_t k = 0; k < 4; ++k)
      broken[broken.size() - 4 + k] = static_cast<std::uint8_t>(crc >> (8 * k));
    try {
      const Job job = decode_job_file(broken, "rows.llj");
      EXPECT_EQ(job.size(), job.header.points_total);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::bad_input);
    }
  }
}

TEST(RowJobFile, AWrongCountIsAnError) {
  for (const int wrong : {-1, 1}) {
    Job job = random_row_job(10, 3);
    job.header.points_total += static_cast<std::uint32_t>(wrong);
    const auto bytes = encode_job_file(job);
    EXPECT_THAT(test::error_of([&] { decode_job_file(bytes, "rows.llj"); }),
                HasSubstr("malformed"));
  }
}

TEST(ContinueAt, BeginsDarkAndReachesTheLineInMotion) {
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Job whole = random_row_job(30, random());
    Job job = whole;
    const std::size_t from = random() % job.size();
    const std::size_t first = continue_at(job.rows, from);
    // Within a row, the line before runs dark at the feed.
    const bool inside =
        from >= 1 && whole.rows.lines[from].to.light && whole.rows.lines[from - 1].to.light;
    ASSERT_EQ(first, inside ? from - 1 : from);
    ASSERT_EQ(job.size(), whole.size());
    for (std::size_t k = 0; k < job.size(); ++k) {
      const Line &line = job.rows.lines[k], &wanted = whole.rows.lines[k];
      ASSERT_EQ(line.to, wanted.to);
      if (inside && k == first) {
        for (const std::uint16_t run : job.rows.runs_of(line))
          ASSERT_EQ(wire::run_power(run), 0) << "burnt twice";
        ASSERT_NE(line.runs, 0u);
      } else {
        ASSERT_THAT(job.rows.runs_of(line), testing::ElementsAreArray(whole.rows.runs_of(wanted)));
      }
    }
  }
  Rows none;
  EXPECT_EQ(continue_at(none, 7), 7u);
}

}  // namespace
}  // namespace lamplock::job
