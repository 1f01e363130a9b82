// The settings store: saved values are restored after any loss of power.
#include "firmware/settings/store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "tests/scale.hpp"
#include "tests/settings/dying_flash.hpp"
#include "tests/settings/random_values.hpp"

namespace lamplock::settings {
namespace {

using test::DyingFlash;
using test::PowerLoss;
using test::random_values;
using test::scaled;
using Random = std::mt19937_64;

template <class Flash>
Values loaded(Flash& flash) {
  return Store<Flash>(flash).load();
}

/// The format described in the store's header, implemented independently.
std::vector<std::uint8_t> record(std::uint32_t sequence,
                                 const std::vector<std::pair<std::uint16_t, std::int32_t>>& items) {
  std::vector<std::uint8_t> bytes{'L', 'P', 'T', 'S'};
  const auto put = [&bytes](std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  };
  put(sequence, 4);
  put(static_cast<std::uint32_t>(items.size()), 2);
  put(~static_cast<std::uint32_t>(items.size()), 2);
  for (const auto& [number, value] : items) {
    put(number, 2);
    put(static_cast<std::uint32_t>(value), 4);
  }
  std::uint32_t crc = ~0u;  // CRC-32 bit by bit
  for (const std::uint8_t byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool odd = ((crc ^ (static_cast<std::uint32_t>(byte) >> bit)) & 1) != 0;
      crc = (crc >> 1) ^ (odd ? 0xedb88320u : 0u);
    }
  put(~crc, 4);
  return bytes;
}

template <class Flash>
void place(Flash& flash, std::uint32_t offset, const std::vector<std::uint8_t>& bytes) {
  std::copy(bytes.begin(), bytes.end(), flash.bytes().begin() + offset);
}

TEST(SettingsStore, GivesDefaultsWhenNothingWasEverSaved) {
  DyingFlash flash;
  Store store(flash);
  EXPECT_EQ(store.load(), Values{});
  EXPECT_TRUE(store.empty());
  EXPECT_EQ(store.counters().valid, 0u);
  EXPECT_EQ(store.counters().rejected, 0u);
}

TEST(SettingsStore, WritesTheDocumentedFormat) {
  DyingFlash flash;
  Store store(flash);
  Values values = store.load();
  ASSERT_TRUE(values.set_milli(Id::lamp_frequency, 123'456));
  ASSERT_TRUE(values.set_milli(Id::min_corner_x, -7));
  ASSERT_TRUE(store.save(values));
  std::vector<std::uint8_t> wanted = record(1, {{901, 123'456}, {940, -7}});
  wanted.resize(DyingFlash<>::size, 0xff);
  EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), flash.bytes().begin()));
}

TEST(SettingsStore, ReadsRecordsOfOtherVersions) {
  DyingFlash flash;
  std::vector<std::pair<std::uint16_t, std::int32_t>> items{{901, 50'000}, {901, -1}};
  for (std::uint16_t i = 0; i < 60; ++i) items.emplace_back(2000 + i, i);  // two pages
  place(flash, 3 * flash_page, record(7, items));
  Store store(flash);
  Values values = store.load();
  EXPECT_EQ(values.milli(Id::lamp_frequency), 50'000);
  EXPECT_EQ(store.sequence(), 7u);
  EXPECT_EQ(store.counters().valid, 1u);
  EXPECT_EQ(store.counters().rejected, 0u);
  EXPECT_EQ(store.counters().unknown_values, 61u);
  ASSERT_TRUE(values.set_milli(Id::axes, 2000));
  ASSERT_TRUE(store.save(values));
  EXPECT_EQ(loaded(flash), values);
  EXPECT_EQ(flash.misuses, 0u);
  EXPECT_EQ(flash.bytes()[5 * flash_page], 'L') << "after both pages";
}

TEST(SettingsStore, UnchangedValuesAreNotWrittenAgain) {
  DyingFlash flash;
  Random random(2);
  Store store(flash);
  store.load();
  const Values values = random_values(random);
  ASSERT_TRUE(store.save(values));
  const std::uint64_t programs = flash.programs;
  ASSERT_TRUE(store.save(values));
  Store again(flash);
  ASSERT_TRUE(again.save(again.load()));
  EXPECT_EQ(flash.programs, programs);
}

TEST(SettingsStore, DefaultsAreKeptWhenTheyReplaceOtherValues) {
  DyingFlash flash;
  Random random(3);
  Store store(flash);
  store.load();
  ASSERT_TRUE(store.save(random_values(random)));
  ASSERT_TRUE(store.save(Values{}));
  EXPECT_EQ(loaded(flash), Values{});
}

template <std::uint32_t sectors>
void wear_out(int writes) {
  DyingFlash<sectors> flash(4);
  Random random(sectors);
  Store store(flash);
  Values before = store.load();
  for (int i = 0; i < writes; ++i) {
    const Values values = random_values(random);
    ASSERT_TRUE(store.save(values));
    if (i % 7 == 0) {  // as after a restart
      ASSERT_EQ(store.load(), values);
    }
    before = values;
  }
  EXPECT_EQ(loaded(flash), before);
  EXPECT_EQ(flash.misuses, 0u);
  const auto [least, most] = std::minmax_element(flash.erases.begin(), flash.erases.end());
  EXPECT_LE(*most - *least, 1u);
  // A sector has 16 pages; one that takes two may leave the last one empty.
  const auto erases = std::accumulate(flash.erases.begin(), flash.erases.end(), 0u);
  EXPECT_GE(erases, (flash.programs + 15) / 16);
  EXPECT_LE(erases, (flash.programs + 14) / 15);
}

TEST(SettingsStore, ThousandsOfWritesWearAllSectorsAlike) {
  wear_out<2>(scaled(3000));
  wear_out<4>(scaled(10'000));
}

/// Loses power at random moments; each time the old or the new values must be restored.
template <std::uint32_t sectors>
void die_often(std::uint64_t seed, int deaths) {
  DyingFlash<sectors> flash(seed);
  Random random(seed + 1);
  std::optional<Values> kept;
  while (deaths > 0) {
    Store store(flash);
    const Values before = store.load();
    ASSERT_EQ(before, kept.value_or(Values{}));
    ASSERT_EQ(store.empty(), !kept.has_value());
    // Often at once, so that power losses follow each other; sometimes after a few sectors.
    const auto far = static_cast<unsigned>(random() % 16);
    flash.live_for(1 + random() % (far == 0 ? 60'000 : 1 + (flash_page << (far % 6))));
    Values wanted = before;
    try {
      for (;;) {
        wanted = random_values(random);
        ASSERT_TRUE(store.save(wanted));
        kept = wanted;
      }
    } catch (const PowerLoss&) {
      --deaths;
      const Values after = loaded(flash);
      if (after == wanted) kept = wanted;
      ASSERT_EQ(after, kept.value_or(Values{})) << "neither old nor new";
    }
  }
  ASSERT_EQ(flash.misuses, 0u);
  EXPECT_GT(flash.deaths_in_erase, 0u);
  EXPECT_GT(flash.deaths_in_program, 0u);
}

TEST(SettingsStore, PowerLossLeavesOldOrNew) {
  // Never fewer seeds: power losses while programming are rare beside those while erasing.
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    die_often<2>(seed, std::max(500, scaled(500)));
    die_often<4>(seed + 100, std::max(500, scaled(500)));
  }
}

TEST(SettingsStore, DyingAtEveryByteOfAWriteLeavesOldOrNew) {
  Random random(5);
  // Eight records of two pages fill a sector, sixteen of one.
  bool with_erase = false, without = false;
  for (const int records : {0, 1, 7, 8, 15, 16, 31, 32, 64}) {
    DyingFlash full(6);
    Store filler(full);
    Values old = filler.load();
    for (int i = 0; i < records; ++i) ASSERT_TRUE(filler.save(old = random_values(random)));
    const Values wanted = random_values(random);
    DyingFlash whole = full;
    Store writer(whole);
    writer.load();
    ASSERT_TRUE(writer.save(wanted));
    const bool erases = whole.erases != full.erases;
    (erases ? with_erase : without) = true;
    const std::uint64_t work = whole.work_since(full);
    const auto step = static_cast<std::uint64_t>(std::max(1, 7 / scaled(1)));
    for (std::uint64_t moment = 1; moment <= work; moment += step) {
      DyingFlash flash = full;
      flash.live_for(moment);
      Store store(flash);
      store.load();
      ASSERT_THROW(store.save(wanted), PowerLoss);
      const Values after = loaded(flash);
      ASSERT_TRUE(after == old || after == wanted) << records << " records, byte " << moment;
      Store next(flash);
      next.load();
      ASSERT_TRUE(next.save(wanted));
      ASSERT_EQ(loaded(flash), wanted);
      ASSERT_EQ(flash.misuses, 0u);
    }
  }
  EXPECT_TRUE(with_erase && without);
}

TEST(SettingsStore, GarbageIsRejectedAndCounted) {
  Random random(7);
  for (int i = 0; i < scaled(50); ++i) {
    DyingFlash flash;
    for (std::uint8_t& byte : flash.bytes()) byte = static_cast<std::uint8_t>(random());
    Store store(flash);
    ASSERT_EQ(store.load(), Values{});
    ASSERT_EQ(store.counters().rejected, DyingFlash<>::size / flash_page);
    const Values values = random_values(random);
    ASSERT_TRUE(store.save(values));
    ASSERT_EQ(loaded(flash), values);
    ASSERT_EQ(flash.misuses, 0u);
  }
}

TEST(SettingsStore, AnyFlippedBitOfTheNewestRecordRestoresThePrecedingOne) {
  Random random(8);
  DyingFlash good;
  Store store(good);
  store.load();
  const Values first = random_values(random);
  ASSERT_TRUE(store.save(first));
  Values second = first;
  ASSERT_TRUE(second.set_milli(Id::lamp_drift, first.milli(Id::lamp_drift) == 10 ? 11 : 10));
  ASSERT_TRUE(store.save(second));
  std::uint32_t end = 2 * flash_page;
  while (good.bytes()[end - 1] == 0xff) --end;
  for (std::uint32_t bit = 8 * flash_page; bit < 8 * end; ++bit) {
    DyingFlash flash = good;
    flash.bytes()[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    Store reader(flash);
    ASSERT_EQ(reader.load(), first) << "bit " << bit;
    ASSERT_EQ(reader.counters().rejected, 1u);
  }
}

TEST(SettingsStore, ATornRecordThatIsReadCorrectlyLaterDoesNotOutrankItsSuccessor) {
  Random random(9);
  DyingFlash flash;
  Store store(flash);
  store.load();
  ASSERT_TRUE(store.save(random_values(random)));
  ASSERT_TRUE(store.save(random_values(random)));
  const std::uint8_t weak = flash.bytes()[flash_page + 6];
  flash.bytes()[flash_page + 6] = 0x5a;  // cells near their threshold: read wrongly now
  Store after(flash);
  after.load();
  const Values values = random_values(random);
  ASSERT_TRUE(after.save(values));
  flash.bytes()[flash_page + 6] = weak;  // and correctly later
  EXPECT_EQ(loaded(flash), values);
}

TEST(SettingsStore, WornOutFlashIsReportedAndTheOldValuesAreKept) {
  Random random(10);
  DyingFlash flash;
  Store store(flash);
  store.load();
  const Values old = random_values(random);
  ASSERT_TRUE(store.save(old));
  flash.stuck = 0x10;
  EXPECT_FALSE(store.save(random_values(random)));
  EXPECT_EQ(loaded(flash), old);
  EXPECT_EQ(flash.erases[0], 1u) << "the sector of the valid record was erased";
  flash.stuck = 0;
  const Values values = random_values(random);
  Store again(flash);
  again.load();
  EXPECT_TRUE(again.save(values));
  EXPECT_EQ(loaded(flash), values);
  EXPECT_EQ(flash.misuses, 0u);
}

}  // namespace
}  // namespace lamplock::settings
