// The order of erasing and writing: after any interruption no partial image starts, and the next
// attempt succeeds.
#include "host/flash/flasher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/flash/images.hpp"
#include "tests/flash/loader_model.hpp"
#include "tests/scale.hpp"

namespace lamplock::flash {
namespace {

using test::FlashModel;
using test::LoaderFaults;
using test::LoaderModel;
using test::RefusedAt;

/// One session with a loader model, which may have faults.
FlashResult flash_with(LoaderModel& device, const FlashImage& image,
                       OnFlashProgress on_progress = {}) {
  Picoboot loader(device, LoaderModel::info(true));
  return Flasher(loader, image, std::move(on_progress)).run();
}

FlashResult flash_into(FlashModel& flash, const FlashImage& image) {
  LoaderModel device(flash);
  return flash_with(device, image);
}

/// An image that shares some sectors with `image`.
FlashImage changed(FlashImage image, std::mt19937_64& random) {
  for (Sector& sector : image.sectors)
    if (random() % 2 == 0)
      for (std::uint8_t& byte : sector.bytes) byte = static_cast<std::uint8_t>(random());
  test::stamp(image.sectors.front().bytes);
  return image;
}

TEST(Flasher, EmptyFlashGetsTheImage) {
  FlashModel flash;
  const FlashImage image = test::noise_image(50'000, 1);
  std::vector<FlashProgress> reports;
  LoaderModel device(flash);
  const FlashResult result = flash_with(
      device, image, [&](const FlashProgress& progress) { reports.push_back(progress); });
  EXPECT_EQ(result.sectors, 13u);
  EXPECT_EQ(result.written, 13u);
  EXPECT_TRUE(test::holds(flash.bytes, image));
  EXPECT_TRUE(test::starts(flash.bytes));
  EXPECT_TRUE(device.exclusive());
  ASSERT_FALSE(reports.empty());
  EXPECT_EQ(reports.back().step, FlashProgress::Step::writing);
  EXPECT_EQ(reports.back().done, reports.back().total);
  for (std::size_t i = 1; i < reports.size(); ++i) {
    EXPECT_TRUE(reports[i].step != reports[i - 1].step || reports[i].done > reports[i - 1].done)
        << i;
  }
}

TEST(Flasher, BootSectorIsErasedFirstAndItsCodeWrittenLast) {
  std::mt19937_64 random(2);
  const FlashImage old = test::noise_image(30'000, 1), image = changed(old, random);
  FlashModel flash;
  flash_into(flash, old);
  flash.erased_sectors.clear();
  flash.programmed_pages.clear();
  flash_into(flash, image);
  ASSERT_FALSE(flash.erased_sectors.empty());
  EXPECT_EQ(flash.erased_sectors.front(), 0u);
  EXPECT_EQ(std::count(flash.erased_sectors.begin(), flash.erased_sectors.end(), 0u), 1);
  EXPECT_EQ(flash.programmed_pages.back(), 0u);
}

TEST(Flasher, WritesOnlySectorsThatDiffer) {
  std::mt19937_64 random(7);
  for (int i = 0; i < lamplock::test::scaled(50); ++i) {
    FlashModel flash;
    for (std::uint8_t& byte : flash.bytes) byte = static_cast<std::uint8_t>(random());
    const FlashImage old = test::noise_image(4'000 + random() % 40'000, random());
    flash_into(flash, old);
    const FlashModel before = flash;
    const FlashImage image = changed(old, random);
    flash.erased_sectors.clear();
    const FlashResult result = flash_into(flash, image);
    std::size_t differing = 0;
    for (std::size_t k = 0; k < image.sectors.size(); ++k) {
      const bool differs = image.sectors[k].bytes != old.sectors[k].bytes;
      differing += differs ? 1 : 0;
      const auto erased_here = std::count(flash.erased_sectors.begin(), flash.erased_sectors.end(),
                                          image.sectors[k].address - flash_base);
      if (k > 0) {
        EXPECT_EQ(erased_here, differs ? 1 : 0);
      }
    }
    const bool boot_too = image.sectors[0].bytes != old.sectors[0].bytes;
    EXPECT_EQ(result.written, differing == 0 ? 0 : differing + (boot_too ? 0 : 1));
    EXPECT_TRUE(test::holds(flash.bytes, image));
    // The settings and all other sectors are unchanged.
    const auto end = static_cast<std::ptrdiff_t>(image.sectors.size() * sector_size);
    EXPECT_TRUE(
        std::equal(flash.bytes.begin() + end, flash.bytes.end(), before.bytes.begin() + end));
    // A second run changes nothing.
    flash.erased_sectors.clear();
    EXPECT_EQ(flash_into(flash, image).written, 0u);
    EXPECT_TRUE(flash.erased_sectors.empty());
  }
}

TEST(Flasher, AfterACutAtAnyByteNoPartialImageStarts) {
  std::mt19937_64 random(99);
  int old_stayed = 0, in_loader = 0, new_there = 0;
  for (int i = 0; i < lamplock::test::scaled(400); ++i) {
    FlashModel flash;
    const FlashImage old = test::noise_image(6'000 + random() % 20'000, random());
    if (random() % 4 != 0) flash_into(flash, old);
    const FlashImage image = changed(old, random);
    FlashModel trial = flash;
    LoaderModel whole(trial);
    flash_with(whole, image);

    LoaderModel cut(flash, {.cut_at = random() % (whole.steps() + 1)}, random());
    try {
      flash_with(cut, image);
    } catch (const PicobootError& error) {
      EXPECT_EQ(error.exit(), Exit::no_device);
    }
    const bool is_old = test::holds(flash.bytes, old), is_new = test::holds(flash.bytes, image);
    if (test::starts(flash.bytes)) {
      ASSERT_TRUE(is_old || is_new) << "a partial image starts";
    }
    old_stayed += is_old && !is_new ? 1 : 0;
    new_there += is_new ? 1 : 0;
    in_loader += test::starts(flash.bytes) ? 0 : 1;
    flash_into(flash, image);
    ASSERT_TRUE(test::holds(flash.bytes, image) && test::starts(flash.bytes));
  }
  if (lamplock::test::scaled(400) >= 400) {
    EXPECT_GT(old_stayed, 0);
    EXPECT_GT(in_loader, 100);
    EXPECT_GT(new_there, 0);
  }
}

TEST(Flasher, AfterACutAtAnyStepNoPartialImageStarts) {
  const FlashImage old = test::noise_image(7'000, 11), image = test::noise_image(7'500, 12);
  FlashModel before;
  flash_into(before, old);
  FlashModel trial = before;
  LoaderModel whole(trial);
  flash_with(whole, image);
  std::size_t old_starts = 0, new_starts = 0;
  for (std::size_t cut_at = 0; cut_at <= whole.steps(); ++cut_at) {
    FlashModel flash = before;
    LoaderModel cut(flash, {.cut_at = cut_at}, cut_at);
    if (cut_at < whole.steps()) {
      EXPECT_THROW(flash_with(cut, image), PicobootError) << cut_at;
    } else {
      EXPECT_NO_THROW(flash_with(cut, image));
    }
    const bool is_old = test::holds(flash.bytes, old), is_new = test::holds(flash.bytes, image);
    old_starts += is_old ? 1 : 0;
    new_starts += is_new ? 1 : 0;
    ASSERT_TRUE(is_old || is_new || !test::starts(flash.bytes))
        << "a partial image starts: " << cut_at;
    flash_into(flash, image);
    ASSERT_TRUE(test::holds(flash.bytes, image)) << cut_at;
  }
  EXPECT_GT(old_starts, 0u);
  EXPECT_LT(old_starts, whole.steps());
  EXPECT_GT(new_starts, 0u);
}

TEST(Flasher, WornFlashIsReportedAndDoesNotStart) {
  const FlashImage image = test::noise_image(20'000, 4);
  for (const std::uint32_t at : {300u, 5'000u, 19'000u}) {
    FlashModel flash;
    const std::uint32_t sector = at / sector_size;
    ASSERT_NE(image.sectors[sector].bytes[at % sector_size], 0);
    flash.stuck = {at};
    try {
      flash_into(flash, image);
      ADD_FAILURE() << at;
    } catch (const PicobootError& error) {
      const std::string text = error.what();
      EXPECT_EQ(error.exit(), Exit::job_failed);
      EXPECT_NE(text.find("0x00 was read back"), std::string::npos) << text;
    }
    EXPECT_FALSE(test::starts(flash.bytes));
  }
}

TEST(Flasher, AnEraseWithoutEffectKeepsTheOldImage) {
  std::mt19937_64 random(8);
  const FlashImage old = test::noise_image(20'000, 1), image = changed(old, random);
  FlashModel flash;
  flash_into(flash, old);
  const std::vector<std::uint8_t> before = flash.bytes;
  LoaderModel device(flash, {.erases_nothing = true});
  try {
    flash_with(device, image);
    ADD_FAILURE() << "no error";
  } catch (const PicobootError& error) {
    EXPECT_EQ(error.exit(), Exit::job_failed);
    const std::string text = error.what();
    EXPECT_NE(text.find("0x10000000 was erased"), std::string::npos) << text;
  }
  EXPECT_EQ(flash.bytes, before);
  EXPECT_TRUE(test::starts(flash.bytes));
}

/// Makes the loader refuse one command while the flash contains another image.
void refuse_one(const FlashModel& before, const FlashImage& old, const FlashImage& image,
                const LoaderFaults& faults) {
  FlashModel flash = before;
  LoaderModel device(flash, faults);
  bool failed = false;
  try {
    flash_with(device, image);
  } catch (const PicobootError& error) {
    failed = true;
    EXPECT_EQ(error.exit(), Exit::job_failed);
  }
  const bool is_new = test::holds(flash.bytes, image);
  // An acknowledged command without data that had no effect is found by reading back.
  EXPECT_TRUE(failed || (faults.refused_at != RefusedAt::packet && is_new));
  if (test::starts(flash.bytes)) {
    EXPECT_TRUE(is_new || test::holds(flash.bytes, old));
  }
  EXPECT_FALSE(device.halted());
  flash_into(flash, image);
  EXPECT_TRUE(test::holds(flash.bytes, image));
}

TEST(Flasher, AfterAnyRefusalTheLoaderKeepsRunning) {
  const FlashImage old = test::noise_image(10'000, 5), image = test::noise_image(10'000, 6);
  FlashModel before;
  flash_into(before, old);
  FlashModel trial = before;
  LoaderModel whole(trial);
  flash_with(whole, image);
  ASSERT_GT(whole.commands(), 10u);
  for (std::size_t command = 0; command < whole.commands(); ++command)
    for (const RefusedAt at : {RefusedAt::packet, RefusedAt::first_data, RefusedAt::last_data})
      for (std::uint32_t status = 1; status <= 17; ++status) {
        refuse_one(before, old, image,
                   {.refused_command = command, .refused_at = at, .status = status});
        ASSERT_FALSE(HasFailure()) << command << ' ' << static_cast<int>(at) << ' ' << status;
      }
}

}  // namespace
}  // namespace lamplock::flash
