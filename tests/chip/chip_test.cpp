// The chip as a whole: behaviour that depends on the wiring between its blocks.
#include "sim/chip/chip.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "shared/boards/boot2_crc32.hpp"

namespace lamplock::sim::chip::chip_test {
namespace {

constexpr std::uint32_t set_alias = 0x2000, clear_alias = 0x3000;
constexpr std::uint32_t resets = 0x4000'c000, reset_usbctrl = 1u << 24;
constexpr std::uint32_t psm_wdsel = 0x4001'0008, psm_xip = 1u << 12;
constexpr std::uint32_t watchdog = 0x4005'8000, reason = watchdog + 0x8, scratch0 = watchdog + 0xc;
constexpr std::uint32_t trigger = 1u << 31, reason_timer = 1, reason_force = 2;
constexpr std::uint32_t brown_out_detector = 0x4006'4004, chip_reset = 0x4006'4008;
constexpr std::uint32_t had_por = 1u << 8, had_run = 1u << 16;
constexpr std::uint32_t xip_ctrl = 0x1400'0000, cache_memory = 0x1500'0000;
constexpr std::uint32_t ssi_enable = 0x1800'0008;
constexpr std::uint32_t in_sram = 0x2000'8000;

class ChipTest : public testing::Test {
 protected:
  ChipTest() {
    // boot2: B .
    ImagePart boot2{0x1000'0000, std::vector<std::uint8_t>(256)};
    boot2.bytes[0] = 0xfe;
    boot2.bytes[1] = 0xe7;
    const std::uint32_t crc = boards::boot2_crc32(std::span(boot2.bytes).first(252));
    for (std::size_t i = 0; i < 4; ++i)
      boot2.bytes[252 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
    chip_.load({{boot2}, {}}, "test");
    chip_.power_on();
  }
  std::uint32_t read(std::uint32_t address) {
    const Access access = chip_.bus().read(address, Width::word, Master::core0, chip_.now());
    EXPECT_FALSE(access.fault) << std::hex << address;
    return access.value;
  }
  void write(std::uint32_t address, std::uint32_t value) {
    EXPECT_FALSE(chip_.bus().write(address, value, Width::word, Master::core0, chip_.now()).fault);
  }
  void run(Picoseconds time) { chip_.run_until(chip_.wheel().cycle_at(chip_.time() + time)); }
  /// Erasing a sector takes 45 ms.
  void begin_erase() {
    FlashChip& flash = chip_.flash();
    const auto command = [&](std::initializer_list<std::uint8_t> bytes) {
      flash.select(chip_.time());
      for (const std::uint8_t byte : bytes) flash.transfer(byte, chip_.time());
      flash.deselect(chip_.time());
    };
    command({0x06});
    command({0x20, 0x01, 0x00, 0x00});
    ASSERT_TRUE(flash.busy(chip_.time()));
  }
  void pull_up() {
    write(resets + clear_alias, reset_usbctrl);
    write(0x5011'0074, 1 | 8);     // USB_MUXING
    write(0x5011'0078, 4 | 8);     // USB_PWR: VBUS detected
    write(0x5011'0040, 1);         // MAIN_CTRL
    write(0x5011'004c, 1u << 16);  // SIE_CTRL.PULLUP_EN
  }
  void fire_watchdog() { write(watchdog + set_alias, trigger); }

  Chip chip_;
};

TEST_F(ChipTest, StartsWithNothingToReport) {
  run(10 * ps_per_ms);
  EXPECT_EQ(chip_.rom().state(), RomState::running);
  EXPECT_THAT(chip_.not_modelled(), testing::IsEmpty());
}

TEST_F(ChipTest, APeekAtAnyRegisterReportsNothingAndAReadDoes) {
  std::vector<std::uint32_t> blocks{0x1400'0000, 0x1800'0000, 0xd000'0000};
  for (std::uint32_t i = 0; i < 28; ++i) blocks.push_back(0x4000'0000 + 0x4000 * i);
  for (const std::uint32_t i : {0x00u, 0x11u, 0x20u, 0x30u, 0x40u})
    blocks.push_back(0x5000'0000 + 0x1'0000 * i);
  write(resets, 0);
  for (const Master core : {Master::core0, Master::core1})
    for (const std::uint32_t block : blocks)
      for (std::uint32_t offset = 0; offset < 0x1000; offset += 4)
        chip_.bus().peek(block + offset, core);
  for (std::uint32_t offset = 0; offset < 0x1000; offset += 4)
    EXPECT_TRUE(chip_.core(0).peek_system(0xe000'e000 + offset));
  EXPECT_THAT(chip_.not_modelled(), testing::IsEmpty());
  for (const std::uint32_t address :
       {0x4001'c084u, 0x4002'8010u, 0x5000'0c00u, 0x5020'0200u, 0x1400'0020u, 0x4002'001cu}) {
    const std::size_t before = chip_.not_modelled().size();
    EXPECT_EQ(read(address), 0u);
    EXPECT_EQ(chip_.not_modelled().size(), before + 1) << std::hex << address;
  }
}

TEST_F(ChipTest, AWriteWhereThereIsNoRegisterIsReported) {
  write(resets, 0);
  write(0x1400'0020, 1);
  write(0x4002'001c, 1);
  EXPECT_THAT(chip_.not_modelled(), testing::ElementsAre("XIP_CTRL: no register at this offset",
                                                         "PADS_QSPI: no register at this offset"));
}

// A write through an alias reads the register first.
TEST_F(ChipTest, AWriteThroughAnAliasIsReportedOnce) {
  write(resets, 0);
  write(0x5020'0200 + set_alias, 1);
  write(0x5000'0c00 + set_alias, 1);
  EXPECT_THAT(chip_.not_modelled(),
              testing::ElementsAre("PIO0: write of offset 512", "DMA: write of offset 3072"));
}

TEST_F(ChipTest, ReportsItsResetCause) {
  // 100 counts of the watchdog, two per tick, ticks of 12 cycles of the ring oscillator.
  const auto count_down = [this] {
    write(watchdog + 0x2c, 1u << 9 | 12);
    write(watchdog + 0x4, 100);
    write(watchdog + set_alias, 1u << 30);
    write(psm_wdsel, 0x1'fffc);
    run(ps_per_ms);
  };
  const auto force = [this] {
    write(psm_wdsel, 0x1'fffc);
    fire_watchdog();
  };
  struct Reset {
    const char* what;
    std::function<void()> happens;
    std::uint32_t cause, reason;
    bool keeps_scratch, keeps_sram;
  };
  const std::vector<Reset> all{
      {"power-up", [] {}, had_por, 0, true, true},
      {"watchdog forced", force, had_por, reason_force, true, true},
      {"RUN", [this] { chip_.run_pin(); }, had_run, 0, false, true},
      {"watchdog counted", count_down, had_run, reason_timer, true, true},
      {"brown-out", [this] { chip_.brown_out(); }, had_por, 0, false, false},
      {"RUN, power cut", [this] { chip_.run_pin(), chip_.power_cut(); }, had_por, 0, false, false},
      {"RUN again", [this] { chip_.run_pin(); }, had_run, 0, false, true},
      {"brown-out undetected", [this] { write(brown_out_detector, 0x90), chip_.brown_out(); },
       had_run, 0, true, true}};
  for (const Reset& reset : all) {
    SCOPED_TRACE(reset.what);
    write(scratch0, 7);
    write(in_sram, 0x1234'5678);
    reset.happens();
    EXPECT_EQ(read(chip_reset), reset.cause);
    EXPECT_EQ(read(reason), reset.reason);
    EXPECT_EQ(read(scratch0), reset.keeps_scratch ? 7u : 0u);
    EXPECT_EQ(read(in_sram) == 0x1234'5678u, reset.keeps_sram);
  }
  EXPECT_EQ(chip_.watchdog_resets(), 2u);
  chip_.run_pin();
  EXPECT_EQ(read(brown_out_detector), 0x91u);
}

TEST_F(ChipTest, RestartsAfterEachReset) {
  run(10 * ps_per_ms);
  for (const auto reset : {&Chip::power_cut, &Chip::brown_out, &Chip::run_pin}) {
    (chip_.*reset)();
    run(ps_per_us);
    EXPECT_EQ(chip_.rom().state(), RomState::booting);
    run(10 * ps_per_ms);
    EXPECT_EQ(chip_.rom().state(), RomState::running);
  }
  EXPECT_THAT(chip_.not_modelled(), testing::IsEmpty());
}

TEST_F(ChipTest, OnlyAPowerCutStopsTheFlash) {
  begin_erase();
  chip_.brown_out();
  chip_.run_pin();
  EXPECT_TRUE(chip_.flash().busy(chip_.time()));
  run(10 * ps_per_ms);
  EXPECT_EQ(chip_.rom().state(), RomState::booting) << "the ROM tries until the flash answers";
  run(45 * ps_per_ms);
  EXPECT_EQ(chip_.rom().state(), RomState::running);
  begin_erase();
  chip_.power_cut();
  EXPECT_FALSE(chip_.flash().busy(chip_.time()));
}

TEST_F(ChipTest, TheWatchdogResetsExecutionInPlaceIfSelected) {
  // Stages after XIP alone, or those before it as well (2.13.1).
  for (const std::uint32_t selected : {0x1'e000u, 0x1'fffcu}) {
    write(xip_ctrl, 2);  // cache off: its memory is readable
    write(cache_memory, 5);
    write(ssi_enable, 1);
    write(psm_wdsel, selected);
    fire_watchdog();
    const bool reset = (selected & psm_xip) != 0;
    EXPECT_EQ(read(xip_ctrl), reset ? 3u : 2u);
    EXPECT_EQ(read(ssi_enable), reset ? 0u : 1u);
    EXPECT_EQ(chip_.bus().read(cache_memory, Width::word, Master::core0, chip_.now()).fault, reset);
  }
}

TEST_F(ChipTest, UsbNeedsClkUsb) {
  pull_up();
  EXPECT_THAT(chip_.usb().violations(), testing::ElementsAre(testing::HasSubstr("clk_usb at 0")));
}

TEST_F(ChipTest, UsbAccepts48MHz) {
  write(resets + clear_alias, reset_usbctrl | 1u << 13);  // and PLL_USB
  write(0x4002'400c, 1);                                  // XOSC: STARTUP, CTRL
  write(0x4002'4000, 0xfabaa0);
  run(ps_per_ms);
  write(0x4002'c008, 100);  // PLL_USB: 12 MHz * 100 / 5 / 5
  write(0x4002'c00c, 5u << 16 | 5u << 12);
  write(0x4002'c004, 0);
  run(ps_per_ms);
  write(0x4000'8054, 1u << 11);  // clk_usb
  pull_up();
  EXPECT_TRUE(chip_.usb().pull_up());
  write(psm_wdsel, 0x1'ffff);
  fire_watchdog();
  EXPECT_FALSE(chip_.usb().pull_up());
  EXPECT_THAT(chip_.usb().violations(), testing::IsEmpty());
}

TEST_F(ChipTest, BitsThatAWriteClearsPassTheGateOfResets) {
  write(resets + clear_alias, reset_usbctrl);
  // EP_ABORT on idle endpoints is done at once; each EP_ABORT_DONE bit is cleared by a written 1.
  write(0x5011'0060, 0x0f);
  EXPECT_EQ(read(0x5011'0064), 0x0fu);
  write(0x5011'0064 + clear_alias, 0x01);
  EXPECT_EQ(read(0x5011'0064), 0x0eu);
  write(0x5011'0064 + set_alias, 0x02);
  EXPECT_EQ(read(0x5011'0064), 0x0cu);
}

}  // namespace
}  // namespace lamplock::sim::chip::chip_test
