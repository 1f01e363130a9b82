// Flashing to the boot ROM's loader of the chip simulator, which was written independently from the
// datasheet, with simulated flash, power and time.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/flash/uf2.hpp"
#include "host/flash/update.hpp"
#include "host/usb/simulated_usb.hpp"
#include "tests/flash/images.hpp"
#include "tests/paths.hpp"
#include "tests/scale.hpp"

namespace lamplock::flash {
namespace {

using sim::chip::Chip;
using sim::chip::Cycle;
using sim::chip::RomState;
using std::chrono::milliseconds;
using usb::SimulatedUsb;

/// Time from power-up until the loader has searched for a program (datasheet, 2.8.1.3) and is on
/// the bus.
constexpr milliseconds loader_time{700};

std::span<const std::uint8_t> contents(Chip& chip) { return chip.flash().storage(); }

void put(Chip& chip, const FlashImage& image) {
  for (const Sector& sector : image.sectors)
    std::copy(sector.bytes.begin(), sector.bytes.end(),
              chip.flash().storage().begin() + (sector.address - flash_base));
}

/// Flashes an image to the first device on the bus, which must be a loader.
FlashResult flash_loader(SimulatedUsb& bus, const FlashImage& image) {
  const auto devices = bus.devices();
  if (devices.empty()) throw Error(Exit::no_device, "test", "no loader", "look");
  const auto device = bus.open(devices.front());
  Picoboot loader(*device, devices.front());
  return Flasher(loader, image, {}).run();
}

/// An image whose boot sector and second sector differ from the old image.
FlashImage small_image(std::uint64_t seed) { return test::noise_image(2 * sector_size, seed); }

#ifdef LAMPLOCK_HAS_FIRMWARE
TEST(ChipFlash, EmptyChipGetsTheFirmwareAndRunsIt) {
  const FlashImage image = make_flash_image(
      read_uf2(read_file(lamplock::test::in_build("lamplock-rp2040.uf2")), "uf2"), "uf2");
  Chip chip;
  chip.power_on();
  SimulatedUsb bus(chip);
  DirectPorts ports(bus);
  bus.sleep(loader_time);
  const UpdateReport report = Update({bus, ports, {}}, image, {}).run("");
  EXPECT_TRUE(test::holds(contents(chip), image));
  ASSERT_TRUE(report.flash.has_value());
  EXPECT_EQ(report.flash->written, image.sectors.size());
  EXPECT_EQ(report.board.manufacturer, "lamplock");
  EXPECT_FALSE(report.board.serial.empty());
  EXPECT_FALSE(report.version.empty()) << report.version_problem;
  EXPECT_TRUE(chip.usb().violations().empty());

  // The firmware runs: now enter the loader by `$BOOT`; nothing differs.
  const UpdateReport again = Update({bus, ports, {}}, image, {}).run(report.board.serial);
  EXPECT_EQ(again.version_before, report.version);
  EXPECT_EQ(again.version, report.version);
  EXPECT_EQ(again.flash->written, 0u);
  EXPECT_TRUE(chip.usb().violations().empty());
}
#endif

/// An attempt with a power failure, and the resulting flash.
struct Cut {
  bool starts = false, is_old = false, is_new = false, in_loader = false;
};

/// Power fails at `at` of the chip's time. The run of the chip ends exactly there.
Cut cut_off(const FlashImage& old, const FlashImage& image, sim::Picoseconds at,
            std::uint64_t seed) {
  sim::chip::ChipOptions options;
  options.seed = seed;
  Chip chip(options);
  bool is_cut = false;
  const auto run = [&](Cycle to) {
    if (is_cut || chip.wheel().time() + sim::ps_per_us < at) return chip.run_until(to);
    is_cut = true;
    chip.power_cut();
  };
  put(chip, old);
  chip.flash().storage()[255] ^= 1;  // the ROM finds no program and waits in its loader
  chip.power_on();
  SimulatedUsb bus(chip, run);
  bus.sleep(loader_time);
  chip.flash().storage()[255] ^= 1;
  try {
    flash_loader(bus, image);
  } catch (const Error&) {
  }
  while (!is_cut) bus.sleep(milliseconds(1));
  Cut cut{test::starts(contents(chip)), test::holds(contents(chip), old),
          test::holds(contents(chip), image), false};
  if (cut.starts) return cut;
  // An image that does not start waits for the next attempt, which succeeds.
  bus.sleep(loader_time);
  cut.in_loader = chip.rom().state() == RomState::bootsel;
  flash_loader(bus, image);
  EXPECT_TRUE(test::starts(contents(chip)) && test::holds(contents(chip), image));
  EXPECT_TRUE(chip.usb().violations().empty());
  return cut;
}

TEST(ChipFlash, AfterAPowerCutAtAnyTimeNoPartialImageStarts) {
  const FlashImage old = small_image(1), image = small_image(2);
  std::mt19937_64 random(5);
  int starts = 0, in_loader = 0;
  const int cuts = lamplock::test::scaled(50);
  for (int i = 0; i < cuts; ++i) {
    // Enumeration takes 130 ms, everything about 320 ms.
    const auto at = static_cast<sim::Picoseconds>(830 + random() % 330) * sim::ps_per_ms +
                    static_cast<sim::Picoseconds>(random() % sim::ps_per_ms);
    const Cut cut = cut_off(old, image, at, random());
    EXPECT_TRUE(cut.starts ? cut.is_old || cut.is_new : cut.in_loader)
        << "cut at " << at / sim::ps_per_us << " us";
    starts += cut.starts ? 1 : 0;
    in_loader += cut.in_loader ? 1 : 0;
  }
  if (cuts >= 24) {
    EXPECT_GT(starts, 0);
    EXPECT_GT(in_loader, 5);
  }
}

TEST(ChipFlash, RefusalsOfTheRomAreReported) {
  Chip chip;
  chip.power_on();
  SimulatedUsb bus(chip);
  bus.sleep(loader_time);
  const auto devices = bus.devices();
  ASSERT_EQ(devices.size(), 1u);
  const auto device = bus.open(devices[0]);
  Picoboot loader(*device, devices[0]);
  loader.exit_xip();
  const auto status_of = [](auto&& command) -> std::optional<PicobootStatus> {
    try {
      command();
    } catch (const PicobootError& error) {
      return error.status();
    }
    return std::nullopt;
  };
  for (const std::size_t size : {page_size, 4 * page_size}) {
    std::vector<std::uint8_t> bytes(size);
    EXPECT_EQ(status_of([&] { loader.read(flash_base + 1, bytes); }),
              PicobootStatus::bad_alignment);
    EXPECT_EQ(status_of([&] { loader.write(flash_base + 1, bytes); }),
              PicobootStatus::bad_alignment);
    EXPECT_EQ(status_of([&] { loader.write(0x4000'0000, bytes); }),
              PicobootStatus::invalid_address);
    EXPECT_NO_THROW(loader.erase(flash_base + 1, sector_size));
    EXPECT_NO_THROW(loader.read(flash_base, bytes));
    EXPECT_EQ(bytes, std::vector<std::uint8_t>(size, erased)) << "the flash must be unchanged";
  }
  EXPECT_TRUE(chip.usb().violations().empty());
}

TEST(ChipFlash, ARestartedDeviceIsANewOne) {
  Chip chip;
  chip.power_on();
  SimulatedUsb bus(chip);
  EXPECT_TRUE(bus.devices().empty());
  bus.sleep(loader_time);
  const auto devices = bus.devices();
  ASSERT_EQ(devices.size(), 1u);
  EXPECT_EQ(usb::known_device(devices[0]).kind, usb::Kind::boot_loader);
  EXPECT_EQ(devices[0].name, "RP2 Boot");
  const auto device = bus.open(devices[0]);
  chip.power_cut();
  bus.sleep(loader_time);
  ASSERT_EQ(bus.devices().size(), 1u);
  std::array<std::uint8_t, 2> status{};
  EXPECT_EQ(device->control({0x82, 0, 0, 3}, status, milliseconds(100)).end,
            usb::TransferEnd::gone);
  EXPECT_EQ(device->bulk_in(0x84, status, milliseconds(100)).end, usb::TransferEnd::gone);
  EXPECT_EQ(bus.open(devices[0])->control({0x82, 0, 0, 3}, status, milliseconds(100)).end,
            usb::TransferEnd::done);
}

}  // namespace
}  // namespace lamplock::flash
