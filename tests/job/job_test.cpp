// Jobs: rounding, work space, overrides; the job file and its refusals.
#include "host/job/job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <string>

#include "host/error.hpp"
#include "host/job/job_file.hpp"
#include "shared/wire/crc32.hpp"
#include "shared/work_space.hpp"
#include "tests/error_of.hpp"
#include "tests/link/random_job.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::job {
namespace {

using geometry::Point;
using geometry::PointCloud;
using settings::Id;
using testing::HasSubstr;

std::string error_of(const PointCloud& points, const Profile& profile = {},
                     const JobOptions& options = {}) {
  return test::error_of([&] { make_job(points, profile, options); });
}

TEST(MakeJob, RoundsEachAxisToItsNearestStep) {
  Profile profile;
  state_setting(profile, Id::steps_per_mm_y, 33.3, "test");
  std::mt19937_64 random(1);
  std::uniform_real_distribution<> mm(-50, 50);
  PointCloud cloud;
  for (int i = 0; i < test::scaled(2000); ++i)
    cloud.push_back({mm(random), mm(random), mm(random)});
  const Job job = make_job(cloud, profile, {});
  ASSERT_EQ(job.targets.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LE(std::abs(job.targets[i].steps[0] - cloud[i].x * 200), 0.5);
    EXPECT_LE(std::abs(job.targets[i].steps[1] - cloud[i].y * 33.3), 0.5 + 1e-9);
    EXPECT_LE(std::abs(job.targets[i].steps[2] - cloud[i].z * 200), 0.5);
    EXPECT_EQ(job.targets[i].steps[3], 0);
    EXPECT_EQ(job.targets[i].shots, 1);
    EXPECT_EQ(job.targets[i].beats, 0);
  }
}

TEST(MakeJob, TheWholeWorkSpaceIsUsable) {
  const Job job = make_job({{-50, -50, -50}, {50, 50, 50}}, {}, {});
  EXPECT_EQ(job.targets[0].steps, (StepPosition{-10000, -10000, -10000, 0}));
  EXPECT_EQ(job.targets[1].steps, (StepPosition{10000, 10000, 10000, 0}));
  const StepLimits limits = work_space(settings::Values{});
  EXPECT_EQ(limits.min, job.targets[0].steps);
  EXPECT_EQ(limits.max, job.targets[1].steps);
}

TEST(MakeJob, PointsOutsideAreNamedAndCounted) {
  const std::string text = error_of({{0, 0, 0}, {0, 50.1, 0}, {1, 2, 3}, {0, 0, -51}});
  EXPECT_THAT(text, HasSubstr("point 1"));
  EXPECT_THAT(text, HasSubstr("(0, 50.1, 0)"));
  EXPECT_THAT(text, HasSubstr("2 of 4"));
  EXPECT_THAT(text, HasSubstr("-50..50"));
}

TEST(MakeJob, NonFiniteNumbersAreErrors) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity, 1e300})
    EXPECT_THAT(error_of({{bad, 0, 0}}), HasSubstr("point 0"));
}

TEST(MakeJob, EmptyCloudsAndBadOptionsAreErrors) {
  EXPECT_THAT(error_of({}), HasSubstr("no points"));
  EXPECT_THAT(error_of({{}}, {}, {.shots = 0}), HasSubstr("flashes"));
  EXPECT_THAT(error_of({{}}, {}, {.channel = 4}), HasSubstr("channel"));
}

TEST(MakeJob, PausesAfterTheGivenNumberOfPoints) {
  PointCloud cloud;
  for (int i = 0; i < 10; ++i) cloud.push_back({i * 1.0, 0, 0});
  const Job job = make_job(cloud, {}, {.pause_every = 4, .pause_beats = 70});
  ASSERT_EQ(job.targets.size(), 12u);  // none at the end
  EXPECT_EQ(job.header.points_total, 12u);
  std::size_t point = 0;
  for (std::size_t i = 0; i < job.targets.size(); ++i) {
    EXPECT_EQ(job.points_before(i), point);
    EXPECT_EQ(job.is_pause(i), i == 4 || i == 9) << i;
    if (job.is_pause(i)) {
      EXPECT_EQ(job.targets[i].steps, job.targets[i - 1].steps);
      EXPECT_EQ(job.targets[i].beats, 70);
    } else {
      EXPECT_EQ(job.targets[i].steps[0], static_cast<int>(point++) * 200);
    }
  }
  // The firmware does not pause for more than 8192 beats at once.
  const Job long_pause = make_job(cloud, {}, {.pause_every = 5, .pause_beats = 65'535});
  std::uint32_t beats = 0;
  for (std::size_t i = 0; i < long_pause.targets.size(); ++i) {
    EXPECT_LE(long_pause.targets[i].beats, 2000);
    if (long_pause.is_pause(i)) beats += long_pause.targets[i].beats;
  }
  EXPECT_EQ(beats, 65'535u);
  EXPECT_EQ(make_job(cloud, {}, {.pause_every = 10, .pause_beats = 1}).targets.size(), 10u);
  EXPECT_THAT(error_of(cloud, {}, {.pause_every = 3}), HasSubstr("a pause has 0 beats"));
}

TEST(MakeJob, TheStageTravelsLessThanTheFocus) {
  JobOptions options;
  options.refraction = {2, 40};
  const Job job = make_job({{1, 2, 40}, {1, 2, 20}, {1, 2, -100}}, {}, options);
  EXPECT_EQ(job.targets[0].steps, (StepPosition{200, 400, 8000, 0}));
  EXPECT_EQ(job.targets[1].steps[2], 6000);
  EXPECT_EQ(job.targets[2].steps[2], -6000);
  EXPECT_EQ(job.refraction, options.refraction);
  EXPECT_THAT(error_of({{0, 0, -141}}, {}, options), HasSubstr("(0, 0, -141)"));
}

TEST(MakeJob, TwoAxesEngraveOnlyThePlane) {
  Profile profile;
  state_setting(profile, Id::axes, 2, "test");
  EXPECT_EQ(make_job({{1, 2, 0}}, profile, {}).header.axes, 2);
  EXPECT_THAT(error_of({{1, 2, 3}}, profile), HasSubstr("outside"));
}

TEST(MakeJob, ContainsGeometryAndStatedSettingsAsOverrides) {
  Profile profile;
  set_lamp_hz(profile, 50);
  state_setting(profile, Id::acceleration_x, 4000, "test");  // stated, although it is the default
  const Job job =
      make_job({{}}, profile, {.mode = wire::JoinMode::start_stop, .dry = true, .energy = 7});
  EXPECT_EQ(job.header.mode, 0);
  EXPECT_TRUE(job.header.dry);
  EXPECT_EQ(job.targets[0].energy, 7);
  EXPECT_EQ(job.header.settings_hash, 0u);
  std::map<int, int> sent;
  for (const auto& item : job.header.used_overrides())
    EXPECT_TRUE(sent.emplace(item.number, item.value_milli).second);
  EXPECT_EQ(sent.at(901), 50'000);
  EXPECT_EQ(sent.at(120), 4'000'000);
  EXPECT_EQ(sent.at(102), 200'000);
  EXPECT_EQ(sent.at(942), -50'000);
  EXPECT_EQ(sent.at(960), 3'000);
  EXPECT_FALSE(sent.contains(2)) << "wiring is not sent to the machine";
  EXPECT_FALSE(sent.contains(103)) << "an axis the machine does not have";
  EXPECT_EQ(apply_overrides({}, job.header), profile.settings);
}

TEST(MakeJob, ChecksSettingsOnRequest) {
  const Job job = make_job({{}}, {}, {.check_settings = true});
  EXPECT_EQ(job.header.settings_hash, settings::Values{}.hash());
}

TEST(MakeJob, EverySettingForJobsFitsTheHeader) {
  Profile profile;
  profile.stated.set();
  state_setting(profile, Id::axes, 4, "test");
  const Job job = make_job({{}}, profile, {});
  EXPECT_EQ(job.header.override_count, settings::job_setting_count);
}

TEST(ApplyOverrides, UnknownNumbersAndValuesOutOfRangeAreErrors) {
  wire::JobHeader header;
  header.override_count = 1;
  header.overrides[0] = {901, 0};
  EXPECT_THROW(apply_overrides({}, header), Error);
  header.overrides[0] = {12345, 0};
  EXPECT_THROW(apply_overrides({}, header), Error);
}

TEST(HeaderFrom, RefersToThePrecedingPoint) {
  const Job job = make_job({{1, 2, 3}, {4, 5, 6}}, {}, {});
  EXPECT_EQ(header_from(job, 0).origin_steps, StepPosition{});
  const wire::JobHeader header = header_from(job, 1);
  EXPECT_EQ(header.first_index, 1u);
  EXPECT_EQ(header.origin_steps, job.targets[0].steps);
  EXPECT_EQ(header.points_total, 2u);
}

TEST(RecordEncoder, TargetsTooFarApartAreAnError) {
  Job job = test::random_job(2, 1);
  job.targets[0].steps[0] = std::numeric_limits<std::int32_t>::min();
  job.targets[1].steps[0] = std::numeric_limits<std::int32_t>::max();
  EXPECT_THROW(RecordEncoder(job, 0).next(100, 10), Error);
}

void expect_same(const Job& a, const Job& b) {
  EXPECT_EQ(a.settings, b.settings);
  ASSERT_EQ(a.targets.size(), b.targets.size());
  for (std::size_t i = 0; i < a.targets.size(); ++i)
    ASSERT_TRUE(test::same(a.targets[i], b.targets[i])) << i;
  wire::JobHeader header = a.header;
  header.settings_hash = a.settings.hash();
  EXPECT_EQ(header, b.header);
}

Job sample(std::size_t points = 3000) {
  Profile profile;
  set_lamp_hz(profile, 62.5);
  Job job = test::random_job(points, 3);
  const Job header = make_job(PointCloud(points), profile, {});
  job.header = header.header;
  job.settings = header.settings;
  return job;
}

/// The error of reading the file; empty if it is accepted.
std::string file_error(std::span<const std::uint8_t> bytes) {
  try {
    decode_job_file(bytes, "job.llj");
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    EXPECT_EQ(std::string(error.what()).rfind("error: job.llj: ", 0), 0u) << error.what();
    return error.what();
  }
  return "";
}

TEST(JobFile, AWrittenJobIsReadBack) {
  const Job job = sample();
  const test::TemporaryFolder folder;
  const auto path = folder.file("job.llj");
  write_job_file(path, job);
  const Job again = read_job_file(path);
  std::filesystem::remove(path);
  expect_same(job, again);
  EXPECT_THROW(read_job_file(path), Error);
  EXPECT_THROW(write_job_file("/nowhere/job.llj", job), Error);
}

TEST(JobFile, ContainsItsGlass) {
  Job job = sample(20);
  const auto plain = encode_job_file(job);
  job.refraction = {1.5168, 12.25};
  const auto bytes = encode_job_file(job);
  EXPECT_EQ(plain[8], 1);
  EXPECT_EQ(bytes[8], 2);
  EXPECT_EQ(decode_job_file(plain, "job").refraction, glass::Refraction{});
  EXPECT_EQ(decode_job_file(bytes, "job").refraction, job.refraction);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_NE(file_error(std::span(bytes).first(size)), "") << size;
  job.refraction.index = 0.5;
  EXPECT_THAT(file_error(encode_job_file(job)), HasSubstr("refraction"));
}

TEST(JobFile, EveryTruncationIsAnError) {
  const auto bytes = encode_job_file(sample(40));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_NE(file_error(std::span(bytes).first(size)), "") << size;
  auto longer = bytes;
  longer.push_back(0);
  EXPECT_NE(file_error(longer), "");
}

TEST(JobFile, EveryFlippedBitIsAnError) {
  const auto bytes = encode_job_file(sample(40));
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      auto broken = bytes;
      broken[at] = static_cast<std::uint8_t>(broken[at] ^ (1u << bit));
      ASSERT_NE(file_error(broken), "") << at;
    }
}

/// Corrects the checksum of changed bytes, as a program with a bug would.
void seal(std::vector<std::uint8_t>& bytes) {
  const auto body = std::span(bytes).first(bytes.size() - 4);
  const std::uint32_t crc = wire::crc32(body);
  for (std::size_t i = 0; i < 4; ++i)
    bytes[bytes.size() - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

TEST(JobFile, InvalidDataWithAGoodChecksumNeverCausesACrash) {
  const auto bytes = encode_job_file(sample(40));
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(3000); ++i) {
    auto broken = bytes;
    broken[random() % (broken.size() - 4)] = static_cast<std::uint8_t>(random());
    seal(broken);
    file_error(broken);
  }
  auto version = bytes;
  version[8] = 9;
  seal(version);
  EXPECT_THAT(file_error(version), HasSubstr("version 9"));
  auto protocol = bytes;
  protocol[12] = 9;
  seal(protocol);
  EXPECT_THAT(file_error(protocol), HasSubstr("another version of the firmware"));
  EXPECT_THAT(file_error(std::vector<std::uint8_t>(100, 'x')), HasSubstr("not a lamplock job"));
}

}  // namespace
}  // namespace lamplock::job
