// The host's side of PICOBOOT with a model of the loader: each refusal has its own message, and the
// session continues after it.
#include "host/flash/picoboot.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "host/flash/flash_image.hpp"
#include "tests/flash/loader_model.hpp"

namespace lamplock::flash {
namespace {

using test::FlashModel;
using test::LoaderFaults;
using test::LoaderModel;
using test::RefusedAt;
using Bytes = std::vector<std::uint8_t>;

/// The error of a call, which must throw one.
template <class Call>
PicobootError error_of(Call&& call) {
  try {
    call();
  } catch (const PicobootError& error) {
    return error;
  }
  ADD_FAILURE() << "no error";
  return {Exit::done, "", ""};
}

TEST(Picoboot, FindsItsInterfaceWithOrWithoutTheDrive) {
  for (const bool with_drive : {true, false}) {
    FlashModel flash;
    flash.bytes[3] = 77;
    LoaderModel device(flash);
    Picoboot loader(device, LoaderModel::info(with_drive));
    EXPECT_EQ(device.resets(), 1u) << "the interface must be reset once";
    loader.exit_xip();
    Bytes bytes(4);
    loader.read(flash_base, bytes);
    EXPECT_EQ(bytes, (Bytes{0xff, 0xff, 0xff, 77}));
  }
  FlashModel flash;
  LoaderModel device(flash);
  usb::DeviceInfo without = LoaderModel::info(true);
  without.interfaces.pop_back();
  EXPECT_NE(std::string(error_of([&] { Picoboot(device, without); }).what()).find("switched off"),
            std::string::npos);
}

TEST(Picoboot, ErasesWritesAndReads) {
  FlashModel flash;
  std::fill(flash.bytes.begin(), flash.bytes.end(), std::uint8_t{0});
  LoaderModel device(flash);
  Picoboot loader(device, LoaderModel::info(true));
  loader.take_exclusive_access();
  EXPECT_TRUE(device.exclusive());
  loader.exit_xip();
  loader.erase(flash_base + 0x2000, 2 * sector_size);
  Bytes data(1000);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i * 7);
  loader.write(flash_base + 0x2100, data);
  Bytes back(data.size());
  loader.read(flash_base + 0x2100, back);
  EXPECT_EQ(back, data);
  EXPECT_EQ(flash.bytes[0x1fff], 0);
  EXPECT_EQ(flash.bytes[0x2000], 0xff);
  EXPECT_EQ(flash.bytes[0x3fff], 0xff);
  EXPECT_EQ(flash.bytes[0x4000], 0);
  loader.reboot(std::chrono::milliseconds(100));
  EXPECT_TRUE(device.rebooted());
}

/// A refused command and its name in the error.
struct Refusal {
  std::string name;
  RefusedAt at;
  std::function<void(Picoboot&)> command;
};

std::vector<Refusal> refusals() {
  static Bytes bytes(3 * page_size);
  const auto erase = [](Picoboot& loader) { loader.erase(flash_base + 0x1000, sector_size); };
  const auto read = [](Picoboot& loader) { loader.read(flash_base + 0x1000, bytes); };
  const auto write = [](Picoboot& loader) { loader.write(flash_base + 0x1000, bytes); };
  return {{"erase at 0x10001000", RefusedAt::packet, erase},
          {"read at 0x10001000", RefusedAt::packet, read},
          {"write at 0x10001000", RefusedAt::packet, write},
          {"read at 0x10001000", RefusedAt::first_data, read},
          {"read at 0x10001000", RefusedAt::last_data, read},
          {"write at 0x10001000", RefusedAt::first_data, write},
          {"write at 0x10001000", RefusedAt::last_data, write}};
}

TEST(Picoboot, EveryStatusHasItsOwnMessage) {
  for (const Refusal& refusal : refusals()) {
    std::set<std::string> lines;
    for (std::uint32_t status = 1; status <= 17; ++status) {
      FlashModel flash;
      LoaderModel device(flash, {.refused_command = 1, .refused_at = refusal.at, .status = status});
      Picoboot loader(device, LoaderModel::info(true));
      loader.exit_xip();
      const PicobootError error = error_of([&] { refusal.command(loader); });
      EXPECT_EQ(error.status(), static_cast<PicobootStatus>(status)) << refusal.name;
      EXPECT_EQ(error.exit(), Exit::job_failed);
      const std::string text = error.what();
      EXPECT_NE(text.find(refusal.name), std::string::npos) << text;
      EXPECT_NE(text.find("; "), std::string::npos) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      // Without the status number the messages must still differ.
      EXPECT_TRUE(lines.insert(text.substr(0, text.find("(status"))).second) << text;
      // The session continues.
      EXPECT_FALSE(device.halted());
      EXPECT_FALSE(device.halted_at_reset()) << "halts must be cleared before a reset";
      EXPECT_NO_THROW(refusal.command(loader)) << text;
    }
  }
}

TEST(Picoboot, AHaltWithoutAStatusIsReported) {
  FlashModel flash;
  LoaderModel device(flash, {.refused_command = 0, .status = 0});
  Picoboot loader(device, LoaderModel::info(true));
  const PicobootError error = error_of([&] { loader.exit_xip(); });
  EXPECT_EQ(error.exit(), Exit::job_failed);
  EXPECT_NE(std::string(error.what()).find("without a reason"), std::string::npos) << error.what();
  EXPECT_NO_THROW(loader.exit_xip());
}

TEST(Picoboot, UnknownAndMissingReasonsAreReported) {
  for (const bool fails : {false, true}) {
    FlashModel flash;
    LoaderModel device(flash, {.refused_command = 0, .status = 4711, .status_fails = fails});
    Picoboot loader(device, LoaderModel::info(true));
    const PicobootError error = error_of([&] { loader.exit_xip(); });
    const std::string text = error.what();
    EXPECT_NE(text.find(fails ? "no reason" : "4711"), std::string::npos) << text;
    EXPECT_NO_THROW(loader.exit_xip());
  }
}

TEST(Picoboot, RealRefusalsAreReported) {
  FlashModel flash;
  LoaderModel device(flash);
  Picoboot loader(device, LoaderModel::info(true));
  loader.exit_xip();
  // Refusals of a single page, which arrive after the page, and of several pages.
  for (const std::size_t size : {1u, 256u, 257u, 1'024u}) {
    Bytes bytes(size);
    EXPECT_EQ(error_of([&] { loader.write(flash_base + 1, bytes); }).status(),
              PicobootStatus::bad_alignment)
        << size;
    EXPECT_EQ(error_of([&] { loader.read(flash_base + 1, bytes); }).status(),
              PicobootStatus::bad_alignment)
        << size;
    EXPECT_EQ(error_of([&] { loader.write(0x4000'0000, bytes); }).status(),
              PicobootStatus::invalid_address)
        << size;
    EXPECT_EQ(error_of([&] { loader.read(0x4000'0000, bytes); }).status(),
              PicobootStatus::invalid_address)
        << size;
    EXPECT_FALSE(device.halted());
    EXPECT_NO_THROW(loader.write(flash_base, bytes));
  }
}

TEST(Picoboot, AnEraseIsAcknowledgedEvenIfItFails) {
  FlashModel flash;
  LoaderModel device(flash);
  Picoboot loader(device, LoaderModel::info(true));
  loader.exit_xip();
  EXPECT_NO_THROW(loader.erase(flash_base + 1, sector_size));
  EXPECT_NO_THROW(loader.erase(flash_base, 100));
  EXPECT_NO_THROW(loader.erase(0x4000'0000, sector_size));
  EXPECT_TRUE(flash.erased_sectors.empty());
  EXPECT_NO_THROW(loader.erase(flash_base, sector_size));
  EXPECT_EQ(flash.erased_sectors.size(), 1u);
}

TEST(Picoboot, SilenceAndLossAreErrorsOfTheLink) {
  FlashModel flash;
  LoaderModel silent(flash, {.silent_command = 0});
  Picoboot first(silent, LoaderModel::info(true));
  const PicobootError no_answer = error_of([&] { first.exit_xip(); });
  EXPECT_EQ(no_answer.exit(), Exit::no_device);
  EXPECT_NE(std::string(no_answer.what()).find("does not answer"), std::string::npos);

  // Three control requests open the session; the command is the next packet.
  LoaderModel cut(flash, {.cut_at = 3});
  Picoboot second(cut, LoaderModel::info(true));
  const PicobootError gone = error_of([&] { second.exit_xip(); });
  EXPECT_EQ(gone.exit(), Exit::no_device);
  EXPECT_NE(std::string(gone.what()).find("unplugged"), std::string::npos);

  LoaderModel taken(flash, {.claimed_by_other = true});
  const PicobootError other = error_of([&] { Picoboot(taken, LoaderModel::info(true)); });
  EXPECT_NE(std::string(other.what()).find("another program"), std::string::npos);
}

}  // namespace
}  // namespace lamplock::flash
