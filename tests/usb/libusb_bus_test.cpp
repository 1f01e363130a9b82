// The real libusb on an emulated computer: the list of devices, missing permissions, and a whole
// image flashed through the kernel's calls.
#include "host/usb/libusb_bus.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/flash/flasher.hpp"
#include "host/run/device_list.hpp"
#include "host/usb/known_devices.hpp"
#include "tests/flash/images.hpp"
#include "tests/usb/as_nobody.hpp"
#include "tests/usb/emulated_usb.hpp"
#include "tests/usb/loader_calls.hpp"

namespace lamplock::usb {
namespace {

using flash::test::FlashModel;
using flash::test::LoaderModel;
using run::DeviceRow;
using std::chrono::milliseconds;
using test::EmulatedDevice;
using test::EmulatedUsb;

class LibusbBusTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::can_be_emulated()) GTEST_SKIP() << "umockdev's library is not preloaded";
    usb_ = std::make_unique<EmulatedUsb>();
  }
  std::unique_ptr<EmulatedUsb> usb_;
};

TEST_F(LibusbBusTest, WithoutDevicesTheListIsEmpty) {
  LibusbBus bus;
  EXPECT_TRUE(bus.devices().empty());
  DeviceInfo none;
  none.place = "1-4";
  EXPECT_THROW(bus.open(none), Error);
}

TEST_F(LibusbBusTest, DevicesAreListedWithTextsAndInterfaces) {
  usb_->add(test::emulated_loader());
  usb_->add(test::emulated_board());
  LibusbBus bus;
  const std::vector<DeviceInfo> devices = bus.devices();
  ASSERT_EQ(devices.size(), 2u);
  const DeviceInfo &board = devices[0], &loader = devices[1];
  EXPECT_EQ(board.place, "1-2");
  EXPECT_EQ(known_device(board).kind, Kind::board);
  EXPECT_EQ(board.serial, "E661640843322A2B");
  EXPECT_EQ(board.problem, "");
  EXPECT_EQ(loader.place, "1-4");
  EXPECT_EQ(known_device(loader).kind, Kind::boot_loader);
  EXPECT_EQ(loader.name, "RP2 Boot");
  EXPECT_EQ(loader.version_bcd, 0x0100);
  EXPECT_EQ(loader.interfaces, LoaderModel::info(true).interfaces);
}

/// Number of these texts that are missing in lists for a user without rights.
int problems_for_nobody(const std::vector<std::string>& wanted) {
  return test::as_nobody([&] {
    LibusbBus bus;
    int missing = 0;
    const std::vector<DeviceRow> rows = run::list_devices(bus);
    for (const std::string& text : wanted)
      missing += std::any_of(rows.begin(), rows.end(),
                             [&](const DeviceRow& row) {
                               return row.problem.find(text) != std::string::npos;
                             })
                     ? 0
                     : 1;
    return missing;
  });
}

TEST_F(LibusbBusTest, MissingPermissionsAreReportedWithTheirRemedy) {
  const EmulatedDevice loader = test::emulated_loader(), board = test::emulated_board();
  usb_->add(loader);
  usb_->add(board);
  usb_->add_below(board, 0, "tty", "tty/ttyACM0", "ttyACM0");
  const std::string node = usb_->real_path("/dev/bus/usb/001/005"),
                    port = usb_->real_path("/dev/ttyACM0");
  ASSERT_EQ(::chmod(node.c_str(), 0600), 0);
  ASSERT_EQ(::chmod(port.c_str(), 0600), 0);
  EXPECT_EQ(problems_for_nobody({"no permission to use /dev/bus/usb/001/005", "60-lamplock.rules",
                                 "no permission to use /dev/ttyACM0"}),
            0);
  ASSERT_EQ(::chmod(node.c_str(), 0666), 0);
  EXPECT_EQ(problems_for_nobody({"/dev/bus/usb/001/005"}), 1) << "permitted";
  // With group dialout, as on Debian, the remedy is a different one.
  if (::geteuid() == 0) {
    constexpr gid_t dialout = 20;
    ASSERT_EQ(::chown(port.c_str(), 0, dialout), 0);
    ASSERT_EQ(::chmod(port.c_str(), 0660), 0);
    EXPECT_EQ(problems_for_nobody({"sudo adduser $USER dialout"}), 0);
  }
}

TEST_F(LibusbBusTest, ListHasPortsPendantsAndMissingDrivers) {
  const EmulatedDevice board = test::emulated_board(),
                       pendant = test::emulated_pendant(0x10ce, 0xeb93);
  usb_->add(board);
  usb_->add(pendant);
  LibusbBus bus;
  std::vector<DeviceRow> rows = run::list_devices(bus);
  ASSERT_GE(rows.size(), 2u);
  EXPECT_EQ(rows[0].use, "--board usb:E661640843322A2B") << "its pulse stream needs no driver";
  EXPECT_NE(rows[0].problem.find("no serial port"), std::string::npos);
  EXPECT_NE(rows[0].problem.find("modprobe cdc_acm"), std::string::npos);
  EXPECT_EQ(rows[1].use, "");
  EXPECT_NE(rows[1].problem.find("no hidraw node"), std::string::npos);
  usb_->add_below(board, 0, "tty", "tty/ttyACM3", "ttyACM3");
  usb_->add_below(pendant, 0, "hidraw", "0003:10CE:EB93.0001/hidraw/hidraw2", "hidraw2");
  rows = run::list_devices(bus);
  EXPECT_EQ(rows[0].kind, "board");
  EXPECT_EQ(rows[0].name, "lamplock picobob");
  EXPECT_EQ(rows[0].board, "picobob");
  EXPECT_EQ(rows[1].board, "");
  EXPECT_EQ(rows[0].node, "/dev/ttyACM3");
  EXPECT_EQ(rows[0].use, "--board usb:E661640843322A2B, --board /dev/ttyACM3, lamplock flash");
  EXPECT_EQ(rows[0].problem, "");
  EXPECT_EQ(rows[1].kind, "pendant");
  EXPECT_EQ(rows[1].use, "lamplock jog");
  EXPECT_EQ(rows[1].name, "XHC WHB04B");
  EXPECT_EQ(rows[1].node, "/dev/hidraw2");
}

/// Either way to a board is enough; the problem of the other one is reported.
TEST_F(LibusbBusTest, ABoardIsUsableByEitherWay) {
  const EmulatedDevice board = test::emulated_board();
  usb_->add(board);
  usb_->add_below(board, 0, "tty", "tty/ttyACM0", "ttyACM0");
  LibusbBus bus;
  std::filesystem::remove(usb_->real_path("/dev/bus/usb/001/006"));
  DeviceRow row = run::list_devices(bus).at(0);
  EXPECT_EQ(row.use, "--board /dev/ttyACM0, lamplock flash");
  EXPECT_NE(row.problem.find("there is no /dev/bus/usb/001/006"), std::string::npos);
  std::filesystem::remove(usb_->real_path("/dev/ttyACM0"));
  row = run::list_devices(bus).at(0);
  EXPECT_EQ(row.use, "");
  EXPECT_NE(row.problem.find("there is no /dev/bus/usb/001/006"), std::string::npos);
  EXPECT_NE(row.problem.find("there is no /dev/ttyACM0"), std::string::npos);
}

TEST_F(LibusbBusTest, ABoardWithOldFirmwareHasOnlyItsPort) {
  const EmulatedDevice board = test::emulated_old_board();
  usb_->add(board);
  LibusbBus bus;
  DeviceRow row = run::list_devices(bus).at(0);
  EXPECT_EQ(row.kind, "board");
  EXPECT_EQ(row.use, "");
  EXPECT_NE(row.problem.find("no serial port"), std::string::npos);
  usb_->add_below(board, 0, "tty", "tty/ttyACM0", "ttyACM0");
  row = run::list_devices(bus).at(0);
  EXPECT_EQ(row.use, "--board /dev/ttyACM0, lamplock flash");
  EXPECT_EQ(row.problem, "");
}

TEST_F(LibusbBusTest, ImageIsFlashedThroughTheKernelsCalls) {
  FlashModel flash;
  LoaderModel model(flash);
  const EmulatedDevice loader = test::emulated_loader();
  test::LoaderCalls calls(model);
  usb_->attach(loader, calls);
  usb_->add(loader);
  LibusbBus bus;
  const std::vector<DeviceInfo> devices = bus.devices();
  ASSERT_EQ(devices.size(), 1u);
  const auto device = bus.open(devices[0]);
  const flash::FlashImage image = flash::test::noise_image(9'000, 3);
  flash::Picoboot session(*device, devices[0]);
  EXPECT_EQ(flash::Flasher(session, image, {}).run().written, 3u);
  EXPECT_TRUE(flash::test::holds(flash.bytes, image));
  // Refusals, their reason, and continuation: IN halted; OUT halted after the last data.
  std::vector<std::uint8_t> page(flash::page_size);
  const auto status_of = [](auto&& command) -> std::optional<flash::PicobootStatus> {
    try {
      command();
    } catch (const flash::PicobootError& error) {
      return error.status();
    }
    return std::nullopt;
  };
  EXPECT_EQ(status_of([&] { session.read(flash::flash_base + 1, page); }),
            flash::PicobootStatus::bad_alignment);
  EXPECT_EQ(status_of([&] { session.write(flash::flash_base + 1, page); }),
            flash::PicobootStatus::bad_alignment);
  EXPECT_TRUE(flash::test::holds(flash.bytes, image));
  EXPECT_FALSE(model.halted());
  session.reboot(milliseconds(1));
  EXPECT_TRUE(model.rebooted());
  std::array<std::uint8_t, 64> packet{};
  EXPECT_EQ(device->bulk_in(LoaderModel::in, packet, milliseconds(50)).end, TransferEnd::gone);
}

TEST_F(LibusbBusTest, TransfersEndWithTheirStatus) {
  FlashModel flash;
  LoaderModel model(flash, {.refused_command = 0, .status = 8});
  const EmulatedDevice loader = test::emulated_loader();
  test::LoaderCalls calls(model);
  usb_->attach(loader, calls);
  usb_->add(loader);
  LibusbBus bus;
  const auto devices = bus.devices();
  const auto device = bus.open(devices.at(0));
  ASSERT_EQ(device->claim(1), TransferEnd::done);
  std::array<std::uint8_t, 64> packet{};
  EXPECT_EQ(device->bulk_in(LoaderModel::in, packet, milliseconds(20)).end, TransferEnd::timed_out);
  EXPECT_EQ(device->control({0x40, 0x99, 0, 0}, {}, milliseconds(100)).end, TransferEnd::stalled);
  std::array<std::uint8_t, 32> command{};
  EXPECT_EQ(device->bulk_out(LoaderModel::out, command, milliseconds(100)).size, 32u);
  EXPECT_EQ(device->bulk_in(LoaderModel::in, packet, milliseconds(100)).end, TransferEnd::stalled);
  EXPECT_EQ(device->clear_halt(LoaderModel::in), TransferEnd::done);
}

TEST(LibusbBus, ListingTheRealComputerIsHarmless) {
  LibusbBus bus;
  for (const DeviceInfo& device : bus.devices()) EXPECT_FALSE(device.place.empty());
}

}  // namespace
}  // namespace lamplock::usb
