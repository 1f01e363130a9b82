// The contents of the page of a job. Its appearance and behaviour are tested in a browser
// (tests/page).
#include "host/report/page.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "host/report/page_series.hpp"
#include "tests/report/job_run.hpp"
#include "tests/scale.hpp"

namespace lamplock::report::test {
namespace {

using Json = nlohmann::json;
using lamplock::test::scaled;

/// The text between two texts.
std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return "";
  const std::size_t start = begin + from.size();
  return text.substr(start, text.find(to, start) - start);
}

Json data_of(const std::string& page) {
  return Json::parse(between(page, R"(<script type="application/json" id="data">)", "</script>"),
                     nullptr, false);
}

std::string base64_decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const auto digit = digits.find(c);
    if (digit == std::string::npos) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xff));
  }
  return bytes;
}

std::string cloud_of(const std::string& page) {
  return base64_decoded(between(page, R"(<script type="text/plain" id="cloud">)", "</script>"));
}

std::uint16_t word(const std::string& bytes, std::size_t at) {
  return static_cast<std::uint16_t>(static_cast<unsigned char>(bytes[at]) |
                                    static_cast<unsigned char>(bytes[at + 1]) << 8);
}

std::string page_of(const JobRun& run) { return page(evaluate(run), run); }

TEST(Page, HasTheNumbersOfTheReport) {
  const JobRun run = perfect_run(300, 1);
  const std::string text = page_of(run);
  const Json data = data_of(text);
  EXPECT_EQ(data["report"], Json::parse(to_json(evaluate(run))));
  EXPECT_EQ(data["estimate"], false);
  EXPECT_EQ(data["warnings"], Json::array());
  EXPECT_EQ(data["settings_table"].size(), settings::setting_count);
}

TEST(Page, HasThePositionOfEveryPoint) {
  for (int i = 0; i < scaled(20); ++i) {
    const JobRun run = perfect_run(1 + 37 * i, static_cast<std::uint64_t>(i));
    const std::string text = page_of(run);
    const Json cloud = data_of(text)["cloud"];
    const std::string bytes = cloud_of(text);
    ASSERT_EQ(bytes.size(), 8 * run.points.size());
    EXPECT_EQ(cloud["count"], run.points.size());
    for (std::size_t p = 0; p < run.points.size(); ++p) {
      const std::array<double, 3> wanted{run.points[p].x, run.points[p].y, run.points[p].z};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double size = cloud["size_mm"][axis];
        const double share = word(bytes, 8 * p + 2 * axis) / 65535.0;
        EXPECT_NEAR(cloud["low_mm"][axis].get<double>() + share * size, wanted[axis],
                    size / 65535 + 1e-12);
      }
      EXPECT_EQ(bytes[8 * p + 6], p == 0 ? 0 : 1) << p;
      EXPECT_EQ(bytes[8 * p + 7], 0) << p;
    }
  }
}

TEST(Page, ReportsMissedPoints) {
  JobRun run = job(50, 3);
  for (std::size_t i = 0; i < 50; ++i)
    if (i != 17 && i != 40) add_shot_at_point(run, i);
  run.beats = 48;
  const std::string text = page_of(run);
  const std::string bytes = cloud_of(text);
  ASSERT_EQ(bytes.size(), 400u);
  for (std::size_t p = 0; p < 50; ++p) EXPECT_EQ(bytes[8 * p + 7], p == 17 || p == 40 ? 1 : 0) << p;
  EXPECT_THAT(data_of(text)["warnings"].dump(), testing::HasSubstr("2 points were not fired"));
}

/// A job that ended before point k: with known shots, and on a board whose shots are counted only.
TEST(Page, PointsAfterAnEarlyEndAreNotReached) {
  for (int i = 0; i < scaled(20); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const std::size_t count = 2 + random() % 60, k = random() % count, missed = random() % count;
    for (const bool shots_known : {true, false}) {
      JobRun run = job(static_cast<int>(count), static_cast<std::uint64_t>(i));
      run.end = {"stopped", k, k, "lamplock send j.llj --from " + std::to_string(k)};
      run.stopped_before = k;
      run.shots_known = shots_known;
      for (std::size_t p = 0; p < k && shots_known; ++p)
        if (p != missed) add_shot_at_point(run, p);
      const std::string text = page_of(run);
      const std::string bytes = cloud_of(text);
      const bool is_missed = shots_known && missed < k;
      for (std::size_t p = 0; p < count; ++p)
        EXPECT_EQ(bytes[8 * p + 7], p >= k ? 2 : is_missed && p == missed ? 1 : 0) << p;
      const Json data = data_of(text);
      EXPECT_EQ(data["cloud"]["not_reached"], count - k);
      EXPECT_THAT(data["warnings"][0].get<std::string>(),
                  testing::StartsWith(fmt::format("Stopped at {} of ", k)));
      EXPECT_EQ(data["warnings"].size(), is_missed ? 2u : 1u) << data["warnings"];
    }
  }
}

/// With a simulated board, which records that there was no shot, and with a real one.
TEST(Page, NoPointOfADryRunIsFired) {
  for (const bool shots_known : {true, false}) {
    JobRun run = job(20, 7);
    run.dry = true;
    run.shots_ordered.assign(20, 0);
    run.shots_known = shots_known;
    run.end = {"done", 20, 20, ""};
    const std::string text = page_of(run), bytes = cloud_of(text);
    for (std::size_t p = 0; p < 20; ++p) EXPECT_EQ(bytes[8 * p + 7], 2) << p;
    const Json data = data_of(text);
    EXPECT_EQ(data["cloud"]["not_reached"], 20);
    EXPECT_EQ(data["warnings"], Json({"Dry run: nothing was fired"}));
    EXPECT_EQ(data["report"]["dry"], true);
    EXPECT_EQ(data["report"]["first_unfired"], nullptr);
    EXPECT_EQ(data["report"]["may_have_fired"], nullptr);
  }
}

/// The whole object is shown, and the points of the run keep their places and beats.
TEST(Page, PointsOfAnEarlierRunComeFirst) {
  const JobRun whole = perfect_run(30, 8);
  JobRun run = job(30, 8);
  constexpr std::ptrdiff_t before = 12;
  run.points_before.assign(run.points.begin(), run.points.begin() + before);
  run.points.erase(run.points.begin(), run.points.begin() + before);
  run.first_number = before;
  for (std::size_t p = 0; p < run.points.size(); ++p) add_shot_at_point(run, p);
  const std::string bytes = cloud_of(page_of(run)), all = cloud_of(page_of(whole));
  ASSERT_EQ(bytes.size(), all.size());
  for (std::size_t p = 0; p < 30; ++p) {
    EXPECT_EQ(bytes.substr(8 * p, 6), all.substr(8 * p, 6)) << p;
    EXPECT_EQ(bytes[8 * p + 6], p <= before ? 0 : 1) << p;
    EXPECT_EQ(bytes[8 * p + 7], p < before ? 3 : 0) << p;
  }
  const Json data = data_of(page_of(run));
  EXPECT_EQ(data["cloud"]["before"], before);
  EXPECT_EQ(data["report"]["from"], before);
  EXPECT_EQ(data["report"]["points_before"], before);
  EXPECT_EQ(data["report"]["points"], 30 - before);
  EXPECT_EQ(data["report"]["size_mm"], data_of(page_of(whole))["report"]["size_mm"]);
}

/// A bar is open only if it has larger values than those of its width.
TEST(Page, LastBarsAreOpenOnlyWithLargerValues) {
  geometry::PointCloud even;
  for (int i = 0; i < 200; ++i) even.push_back({0.5 * i, 0, 0});
  EXPECT_FALSE(spacing_histogram(even).open);
  even.push_back({500, 0, 0});
  EXPECT_TRUE(spacing_histogram(even).open);
  PointBeats beats;
  beats.known = true;
  beats.beat = {0, 1, 33};
  beats.missed = {0, 0, 0};
  EXPECT_FALSE(beats_histogram(beats).open);
  beats.beat.back() = 34;
  EXPECT_TRUE(beats_histogram(beats).open);
}

TEST(Page, ClockNeverRunsBackwards) {
  for (int i = 0; i < scaled(20); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    JobRun run = job(100 + 40 * i, static_cast<std::uint64_t>(i));
    std::vector<std::size_t> late;
    for (std::size_t p = 0; p < run.points.size(); ++p) {
      if (random() % 10 == 0)
        late.push_back(p);
      else
        add_shot_at_point(run, p);
    }
    for (const std::size_t p : late) add_shot_at_point(run, p);
    run.beats = run.shots.size();
    const auto clock = data_of(page_of(run))["clock"].get<std::vector<std::uint32_t>>();
    EXPECT_TRUE(std::is_sorted(clock.begin(), clock.end())) << i;
    // Including late points: all are fired at the end.
    EXPECT_EQ(clock.back(), *std::max_element(clock.begin(), clock.end()));
    if (!late.empty() && late.back() + 1 < run.points.size()) {
      EXPECT_EQ(clock.back(), run.shots.size() - 1) << i;
    }
  }
}

TEST(Page, NumbersPointsLikeTheJob) {
  JobRun run = perfect_run(30, 2);
  run.first_number = 7;
  run.pauses = {0, 10, 10};
  const Json data = data_of(page_of(run));
  EXPECT_EQ(data["first"], 7);
  EXPECT_EQ(data["pauses"], Json({0, 10, 10}));
}

TEST(Page, OmitsShotsThatAreUnknown) {
  JobRun run = job(50, 4);
  run.shots_known = false;
  run.shots_fired = 50;
  const Json data = data_of(page_of(run));
  EXPECT_EQ(data["cloud"]["beats_known"], false);
  EXPECT_EQ(data["cloud"]["fates_known"], false);
  EXPECT_EQ(data["clock"], Json::array());
  EXPECT_EQ(data["utilisation"]["share"], Json::array());
}

TEST(Page, ShowsPredictedBeatsAsAnEstimate) {
  JobRun run = job(4, 5);
  run.shots_known = false;
  run.foreseen_beats = {0, 1, 4, 400};
  run.beats = 401;
  const std::string text = page_of(run);
  EXPECT_EQ(data_of(text)["estimate"], true);
  const std::string bytes = cloud_of(text);
  EXPECT_EQ(bytes[6], 0);
  EXPECT_EQ(bytes[14], 1);
  EXPECT_EQ(bytes[22], 3);
  EXPECT_EQ(static_cast<unsigned char>(bytes[30]), 254);  // this many or more
}

TEST(Page, NeverClosesItsScriptEarly) {
  JobRun run = perfect_run(3, 6);
  run.input = "a</script><script>alert(1)</script><!--.xyz";
  run.warnings = {"</script>", "\xff\xfe is no UTF-8"};
  const std::string text = page_of(run);
  EXPECT_EQ(data_of(text)["report"]["input"], run.input);
  EXPECT_EQ(text.find("alert(1)</script>"), std::string::npos);
}

TEST(Page, AsksNoServer) {
  const std::string text = page_of(perfect_run(10, 7));
  for (const char* sign : {"src=", "href=\"h", "@import", "url(", "fetch(", "XMLHttp", "import("})
    EXPECT_EQ(text.find(sign), std::string::npos) << sign;
  EXPECT_EQ(text.find("@DATA@"), std::string::npos);
  EXPECT_EQ(text.find("@CLOUD@"), std::string::npos);
  EXPECT_EQ(text.find("_JS@"), std::string::npos);
  EXPECT_THAT(text, testing::StartsWith("<!doctype html>"));
}

TEST(Page, OfNoPointsAndOfPointsAtOnePlace) {
  JobRun none;
  EXPECT_EQ(cloud_of(page_of(none)), "");
  JobRun same = job(3, 8);
  same.points = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  same.shots_known = false;
  const Json data = data_of(page_of(same));
  EXPECT_EQ(data["cloud"]["size_mm"], (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(data["spacing_mm"]["least"], 0);
}

TEST(Page, ShowsSomeOfVeryManyPoints) {
  JobRun run;
  run.shots_known = false;
  run.points.resize(2 * max_points_shown + 5);
  for (std::size_t i = 0; i < run.points.size(); ++i) run.points[i].x = static_cast<double>(i);
  const std::string text = page_of(run);
  const Json cloud = data_of(text)["cloud"];
  EXPECT_EQ(cloud["stride"], 3);
  EXPECT_EQ(cloud["count"], (run.points.size() + 2) / 3);
  EXPECT_LT(text.size(), 15'000'000u);
}

TEST(PageSeries, UtilisationIsThatOfTheJob) {
  std::mt19937_64 random(9);
  for (int i = 0; i < scaled(200); ++i) {
    PointBeats beats;
    const auto shots = 1 + random() % 2000;
    std::uint32_t beat = 0;
    for (std::uint64_t k = 0; k < shots; ++k) {
      beats.shots.push_back(beat);
      beat += 1 + static_cast<std::uint32_t>(random() % 4);
    }
    const std::uint64_t total = beats.shots.back() + 1;
    const Utilisation use = utilisation_over_time(beats, total);
    double sum = 0;
    const std::uint64_t bins = use.share.size();
    for (std::uint64_t b = 0; b < bins; ++b) {
      EXPECT_LE(use.share[b], 1);
      const auto begin = (b * total + bins - 1) / bins, end = ((b + 1) * total + bins - 1) / bins;
      sum += use.share[b] * static_cast<double>(end - begin);
    }
    EXPECT_NEAR(sum, static_cast<double>(shots), 1e-6 * static_cast<double>(shots));
  }
}

TEST(PageSeries, SpacingOfALattice) {
  geometry::PointCloud cloud;
  for (int x = 0; x < 12; ++x)
    for (int y = 0; y < 11; ++y)
      for (int z = 0; z < 10; ++z) cloud.push_back({0.1 * x, 0.12 * y, 0.15 * z});
  const Histogram spacing = spacing_histogram(cloud);
  EXPECT_NEAR(spacing.least, 0.1, 1e-12);
  EXPECT_NEAR(spacing.median, 0.1, 1e-12);
  EXPECT_EQ(spacing.values, cloud.size());
  std::uint64_t all = 0;
  for (const std::uint64_t count : spacing.counts) all += count;
  EXPECT_EQ(all, cloud.size());
  EXPECT_EQ(spacing_histogram(cloud, 100).values, 95u);  // every 14th
}

TEST(PageSeries, SpacingAgainstAllPairs) {
  for (int i = 0; i < scaled(10); ++i) {
    const JobRun run = job(200, static_cast<std::uint64_t>(i));
    double least = 1e9;
    for (std::size_t a = 0; a < run.points.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const auto &p = run.points[a], &q = run.points[b];
        least = std::min(least, std::hypot(p.x - q.x, p.y - q.y, p.z - q.z));
      }
    EXPECT_NEAR(spacing_histogram(run.points).least, least, 1e-12);
  }
}

TEST(PageSeries, SpacingOfBrokenClouds) {
  EXPECT_EQ(spacing_histogram({}).values, 0u);
  EXPECT_EQ(spacing_histogram({{1, 2, 3}}).values, 0u);
  EXPECT_EQ(spacing_histogram({{1, 2, 3}, {NAN, 0, 0}}).values, 0u);
  EXPECT_EQ(spacing_histogram({{0, 0, 0}, {1e300, 0, 0}}).values, 2u);
}

TEST(PageSeries, BeatsOfMoves) {
  PointBeats beats;
  beats.known = true;
  beats.beat = {0, 1, 2, 5, 5, 100, 90};
  beats.missed = {0, 0, 0, 0, 1, 0, 0};
  const Histogram ways = beats_histogram(beats);
  EXPECT_EQ(ways.values, 4u);  // neither the missed point nor the late one
  EXPECT_EQ(ways.counts[1], 2u);
  EXPECT_EQ(ways.counts[3], 1u);
  EXPECT_EQ(ways.counts.back(), 1u);
}

}  // namespace
}  // namespace lamplock::report::test
