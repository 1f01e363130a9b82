// Two stores on one flash chip with one buffer, as on a board: settings, and the state that a
// program leaves. Saved contents are restored even if power is lost while the other store writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "firmware/machine/console/persistent_state.hpp"
#include "firmware/settings/store.hpp"
#include "tests/machine/random_persistent_state.hpp"
#include "tests/scale.hpp"
#include "tests/settings/dying_flash.hpp"
#include "tests/settings/random_values.hpp"

namespace lamplock::settings {
namespace {

using machine::PersistentState;
using machine::PersistentStateRecord;
using test::PowerLoss;
using test::random_persistent_state;
using test::random_values;
using test::scaled;
using Random = std::mt19937_64;

constexpr std::uint32_t area_sectors = 4;
constexpr std::uint32_t area_size = area_sectors * flash_sector;
using Chip = test::DyingFlash<2 * area_sectors>;

/// One of two areas of a chip.
class Area {
 public:
  static constexpr std::uint32_t sectors = area_sectors;
  Area(Chip& chip, std::uint32_t offset) : chip_(chip), offset_(offset) {}
  void read(std::uint32_t at, std::span<std::uint8_t> out) const { chip_.read(checked(at), out); }
  void erase(std::uint32_t at) { chip_.erase(checked(at)); }
  void program(std::uint32_t at, std::span<const std::uint8_t, flash_page> page) {
    chip_.program(checked(at), page);
  }

 private:
  std::uint32_t checked(std::uint32_t at) const {
    EXPECT_LT(at, area_size) << "outside of its area";
    return offset_ + at;
  }
  Chip& chip_;
  std::uint32_t offset_;
};

using KeptStore = RecordStore<Area, PersistentStateRecord>;
constexpr std::uint32_t kept_offset = area_size;

/// Both stores as after a start.
struct Stores {
  explicit Stores(Chip& chip) : settings_area(chip, 0), kept_area(chip, kept_offset) {
    values = settings.load();
    program.load(kept);
  }
  Area settings_area, kept_area;
  std::array<std::uint8_t,
             std::max(RecordStore<Area, SettingsRecord>::buffer_size, KeptStore::buffer_size)>
      buffer{};
  RecordStore<Area, SettingsRecord> settings{settings_area, buffer};
  KeptStore program{kept_area, buffer};
  Values values;
  PersistentState kept;
};

TEST(KeptStore, GivesDefaultsWhenNothingWasEverSaved) {
  Chip chip;
  const Stores stores(chip);
  EXPECT_EQ(stores.kept, PersistentState{});
  EXPECT_TRUE(stores.program.empty());
  EXPECT_EQ(stores.program.counters().rejected, 0u);
}

TEST(KeptStore, WritesTheDocumentedFormat) {
  Chip chip;
  Stores stores(chip);
  PersistentState kept;
  ASSERT_TRUE(kept.start_up[1].set("G20"));
  kept.parameters.home_g30_e7[1] = -2;
  ASSERT_TRUE(stores.program.save(kept));
  const auto* at = chip.bytes().data() + kept_offset;
  const std::vector<std::uint8_t> wanted{'L',  'P',  'T',       'K',  1,    0,    0,    0,
                                         40,   0,    0xff - 40, 0xff,  // number, size, its inverse
                                         1,    10,   32,        0,    0,    0,    0,    0,
                                         0,    0,    0,         0xfe, 0xff, 0xff, 0xff, 0xff,
                                         0xff, 0xff, 0xff,      0,    0,    0,    0,    0,
                                         0,    0,    0,         0,    0,    0,    0,    0,
                                         0,    0,    0,         33,   3,    'G',  '2',  '0'};
  EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), at));
  EXPECT_EQ(at[wanted.size() + 4], flash_blank) << "after the CRC";
  EXPECT_TRUE(std::all_of(chip.bytes().begin(), chip.bytes().begin() + area_size,
                          [](auto b) { return b == flash_blank; }));
}

TEST(KeptStore, TransientStateIsNotWritten) {
  Chip chip;
  Stores stores(chip);
  ASSERT_TRUE(stores.program.save(PersistentState{}));
  const std::uint64_t programs = chip.programs;
  PersistentState kept;
  kept.parameters.shift_e7[0] = 1;
  ASSERT_TRUE(stores.program.save(kept));
  EXPECT_EQ(chip.programs, programs);
}

TEST(KeptStore, BothStoresShareTheBufferInTurn) {
  Chip chip;
  Random random(11);
  Stores stores(chip);
  Values values;
  PersistentState kept;
  for (int i = 0; i < scaled(4000); ++i) {
    if (random() % 2 == 0)
      ASSERT_TRUE(stores.settings.save(values = random_values(random)));
    else
      ASSERT_TRUE(stores.program.save(kept = random_persistent_state(random)));
    if (i % 16 != 0) continue;
    const Stores again(chip);
    ASSERT_EQ(again.values, values);
    ASSERT_EQ(again.kept, kept);
    ASSERT_EQ(again.program.counters().unknown_values, 0u);
  }
  EXPECT_EQ(chip.misuses, 0u);
  for (const auto sectors :
       {std::span(chip.erases).first(area_sectors), std::span(chip.erases).last(area_sectors)}) {
    const auto [least, most] = std::minmax_element(sectors.begin(), sectors.end());
    EXPECT_LE(*most - *least, 1u);
  }
}

TEST(KeptStore, DyingAtEveryByteOfAWriteLeavesOldOrNew) {
  Random random(12);
  bool with_erase = false, without = false;
  for (const int records : {0, 1, 5, 6, 8, 15, 16, 31, 32, 64}) {
    Chip full(13);
    Stores filler(full);
    ASSERT_TRUE(filler.settings.save(filler.values = random_values(random)));
    for (int i = 0; i < records; ++i)
      ASSERT_TRUE(filler.program.save(filler.kept = random_persistent_state(random)));
    PersistentState wanted = random_persistent_state(random);
    wanted.parameters.systems_e7[0][0] = filler.kept.parameters.systems_e7[0][0] / 2 + 1;
    Chip whole = full;
    Stores(whole).program.save(wanted);
    const bool erases = whole.erases != full.erases;
    (erases ? with_erase : without) = true;
    const std::uint64_t work = whole.work_since(full);
    const auto step = static_cast<std::uint64_t>(std::max(1, 7 / scaled(1)));
    for (std::uint64_t moment = 1; moment <= work; moment += step) {
      Chip chip = full;
      Stores stores(chip);
      chip.live_for(moment);
      ASSERT_THROW(stores.program.save(wanted), PowerLoss);
      Stores next(chip);
      ASSERT_TRUE(next.kept == filler.kept || next.kept == wanted)
          << records << " records, byte " << moment;
      ASSERT_EQ(next.values, filler.values);
      ASSERT_TRUE(next.program.save(wanted));
      ASSERT_EQ(Stores(chip).kept, wanted);
      ASSERT_EQ(chip.misuses, 0u);
    }
  }
  EXPECT_TRUE(with_erase && without);
}

TEST(KeptStore, PowerLossLeavesOldOrNewAndTheOtherStoreUnchanged) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Chip chip(seed);
    Random random(seed + 20);
    Values values;
    PersistentState kept;
    for (int deaths = std::max(400, scaled(400)); deaths > 0; --deaths) {
      Stores stores(chip);
      ASSERT_EQ(stores.values, values);
      ASSERT_EQ(stores.kept, kept);
      chip.live_for(1 + random() % (random() % 8 == 0 ? 60'000u : 6'000u));
      Values new_values = values;
      PersistentState new_kept = kept;
      try {
        for (;;) {
          if (random() % 2 == 0) {
            ASSERT_TRUE(stores.settings.save(new_values = random_values(random)));
            values = new_values;
          } else {
            ASSERT_TRUE(stores.program.save(new_kept = random_persistent_state(random)));
            kept = new_kept;
          }
        }
      } catch (const PowerLoss&) {
        const Stores after(chip);
        if (after.values == new_values) values = new_values;
        if (after.kept == new_kept) kept = new_kept;
        ASSERT_EQ(after.values, values) << "neither old nor new";
        ASSERT_EQ(after.kept, kept) << "neither old nor new";
      }
    }
    EXPECT_EQ(chip.misuses, 0u);
    EXPECT_GT(chip.deaths_in_erase, 0u);
    EXPECT_GT(chip.deaths_in_program, 0u);
  }
}

TEST(KeptStore, DamagedPagesReturnASavedState) {
  Random random(14);
  for (int i = 0; i < scaled(200); ++i) {
    Chip chip;
    Stores stores(chip);
    std::vector<PersistentState> saved(1);
    for (auto n = 1 + random() % 80; n != 0; --n)
      ASSERT_TRUE(stores.program.save(saved.emplace_back(random_persistent_state(random))));
    const Values values = random_values(random);
    ASSERT_TRUE(stores.settings.save(values));
    for (auto n = 1 + random() % 40; n != 0; --n) {
      const auto page = kept_offset + random() % (area_size / flash_page) * flash_page;
      for (auto k = 1 + random() % 8; k != 0; --k)
        chip.bytes()[page + random() % flash_page] = static_cast<std::uint8_t>(random());
    }
    Stores after(chip);
    ASSERT_NE(std::find(saved.begin(), saved.end(), after.kept), saved.end());
    ASSERT_EQ(after.values, values);
    const PersistentState kept = random_persistent_state(random);
    ASSERT_TRUE(after.program.save(kept));
    ASSERT_EQ(Stores(chip).kept, kept);
    ASSERT_EQ(chip.misuses, 0u);
  }
}

TEST(KeptStore, GarbageIsRejectedAndCounted) {
  Random random(15);
  Chip chip;
  for (std::uint8_t& byte : chip.bytes()) byte = static_cast<std::uint8_t>(random());
  Stores stores(chip);
  EXPECT_EQ(stores.kept, PersistentState{});
  EXPECT_EQ(stores.program.counters().rejected, area_size / flash_page);
  const PersistentState kept = random_persistent_state(random);
  ASSERT_TRUE(stores.program.save(kept));
  EXPECT_EQ(Stores(chip).kept, kept);
}

TEST(KeptStore, RecordsOfTheOtherKindAreIgnored) {
  Random random(16);
  Chip chip;
  Stores stores(chip);
  ASSERT_TRUE(stores.settings.save(random_values(random)));
  std::copy_n(chip.bytes().begin(), area_size, chip.bytes().begin() + kept_offset);
  const Stores after(chip);
  EXPECT_EQ(after.kept, PersistentState{});
  EXPECT_TRUE(after.program.empty());
  EXPECT_GT(after.program.counters().rejected, 0u);
}

TEST(KeptStore, ARecordOfALaterVersionIsSkippedAndReplaced) {
  Chip chip;
  Area area(chip, kept_offset);
  std::array<std::uint8_t, KeptStore::buffer_size> buffer{};
  RecordLog<Area> later(area, buffer, PersistentStateRecord::format);
  later.load();
  std::fill_n(later.begin().begin(), 700, std::uint8_t{2});  // its version, and other bytes
  ASSERT_TRUE(later.save(700));
  Stores stores(chip);
  EXPECT_EQ(stores.kept, PersistentState{});
  EXPECT_EQ(stores.program.counters().valid, 1u);
  EXPECT_EQ(stores.program.counters().unknown_values, 1u);
  Random random(17);
  const PersistentState kept = random_persistent_state(random);
  ASSERT_TRUE(stores.program.save(kept));
  EXPECT_EQ(Stores(chip).kept, kept);
  EXPECT_EQ(chip.misuses, 0u);
}

TEST(KeptStore, WornOutFlashIsReportedAndTheOldProgramIsKept) {
  Random random(18);
  Chip chip;
  Stores stores(chip);
  const PersistentState old = random_persistent_state(random);
  ASSERT_TRUE(stores.program.save(old));
  chip.stuck = 0x10;
  PersistentState other = old;
  other.parameters.systems_e7[3] = {1, 2, 3, 4};
  EXPECT_FALSE(stores.program.save(other));
  EXPECT_EQ(Stores(chip).kept, old);
  chip.stuck = 0;
  Stores again(chip);
  EXPECT_TRUE(again.program.save(other));
  EXPECT_EQ(Stores(chip).kept, other);
}

}  // namespace
}  // namespace lamplock::settings
