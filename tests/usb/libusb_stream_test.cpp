// Streams of the real libusb: bytes both ways, waits, failures, and their ends.
#include <fcntl.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <functional>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "host/usb/libusb_bus.hpp"
#include "tests/scale.hpp"
#include "tests/usb/bulk_device.hpp"
#include "tests/usb/emulated_usb.hpp"

namespace lamplock::usb {
namespace {

using lamplock::test::scaled;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::BulkDevice;
using test::EmulatedUsb;
using Bytes = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

constexpr std::uint8_t stream_interface = 2, out_endpoint = 0x03, in_endpoint = 0x83;
/// Constants of host/usb/libusb_stream.cpp: bytes of its transfers each way, and of its buffer.
constexpr std::size_t queued = 4096, kept = 65'536;
/// Far more than any operation here takes, even on a busy computer.
constexpr seconds long_time{20};

Bytes random_bytes(std::size_t size, std::mt19937_64& random) {
  Bytes bytes(size);
  std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::uint8_t>(random()); });
  return bytes;
}

std::size_t between(std::size_t least, std::size_t most, std::mt19937_64& random) {
  return std::uniform_int_distribution<std::size_t>(least, most)(random);
}

/// Waits until the condition holds; false if it never does.
bool holds_soon(const std::function<bool()>& condition) {
  const Clock::time_point end = Clock::now() + long_time;
  while (!condition()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return true;
}

class LibusbStreamTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::can_be_emulated()) GTEST_SKIP() << "umockdev's library is not preloaded";
    usb_ = std::make_unique<EmulatedUsb>();
    device_ = std::make_unique<BulkDevice>();
    const test::EmulatedDevice board = test::emulated_board();
    usb_->attach(board, *device_);
    usb_->add(board);
    usb_->set_node(board, device_->node());
    bus_ = std::make_unique<LibusbBus>();
    const auto devices = bus_->devices();
    ASSERT_EQ(devices.size(), 1u);
    open_ = bus_->open(devices[0]);
    ASSERT_EQ(open_->claim(stream_interface), TransferEnd::done);
    stream_ = open_->stream(out_endpoint, in_endpoint);
    ASSERT_TRUE(stream_->alive());
  }
  void TearDown() override {
    if (!device_) return;
    stream_.reset();
    EXPECT_EQ(device_->owed(), 0u) << "transfers were forgotten";
    open_.reset();
    EXPECT_FALSE(device_->claimed());
  }

  /// Sends all bytes to the host, waiting as often as necessary.
  void give_all(const Bytes& bytes) {
    std::size_t given = 0;
    EXPECT_TRUE(holds_soon([&] {
      given += device_->give(std::span(bytes).subspan(given));
      return given == bytes.size();
    }));
  }
  Bytes read_all(std::size_t size) {
    Bytes bytes(size);
    std::size_t count = 0;
    EXPECT_TRUE(holds_soon([&] {
      stream_->wait(milliseconds(10));
      count += stream_->read(std::span(bytes).subspan(count));
      return count == size;
    }));
    return bytes;
  }
  Bytes take_all(std::size_t size) {
    Bytes bytes(size);
    std::size_t count = 0;
    EXPECT_TRUE(holds_soon([&] {
      count += device_->take(std::span(bytes).subspan(count));
      return count == size;
    }));
    return bytes;
  }

  std::unique_ptr<EmulatedUsb> usb_;
  std::unique_ptr<BulkDevice> device_;
  std::unique_ptr<LibusbBus> bus_;
  std::unique_ptr<Device> open_;
  std::unique_ptr<Stream> stream_;
  std::mt19937_64 random_{19};
};

TEST_F(LibusbStreamTest, BytesArriveInOrderBothWays) {
  const std::size_t size = 200'000;
  for (int round = 0; round < scaled(4); ++round) {
    const Bytes down = random_bytes(size, random_), up = random_bytes(size, random_);
    Bytes taken, received;
    std::jthread board([&,
                        random = std::mt19937_64(random_())](const std::stop_token& stop) mutable {
      std::size_t given = 0;
      Bytes piece(5'000);
      while (!stop.stop_requested() && (taken.size() < size || given < size)) {
        const std::size_t count = device_->take(std::span(piece).first(between(1, 5'000, random)));
        taken.insert(taken.end(), piece.begin(), piece.begin() + static_cast<long>(count));
        const std::size_t more = std::min(size - given, between(0, 3'000, random));
        given += device_->give(std::span(up).subspan(given, more));
        if (random() % 8 == 0) std::this_thread::sleep_for(microseconds(random() % 1'000));
      }
    });
    std::size_t written = 0;
    Bytes piece(9'000);
    EXPECT_TRUE(holds_soon([&] {
      const std::size_t wish = std::min(size - written, between(0, 9'000, random_));
      written += stream_->write(std::span(down).subspan(written, wish));
      if (random_() % 4 == 0) stream_->wait(microseconds(random_() % 2'000));
      const std::size_t count = stream_->read(std::span(piece).first(between(0, 9'000, random_)));
      received.insert(received.end(), piece.begin(), piece.begin() + static_cast<long>(count));
      return written == size && received.size() == size;
    })) << written
        << " written, " << received.size() << " received";
    EXPECT_TRUE(holds_soon([&] { return device_->waiting_out() == 0; }));
    board.request_stop();
    board.join();
    EXPECT_TRUE(taken == down) << "round " << round;
    EXPECT_TRUE(received == up) << "round " << round;
    EXPECT_TRUE(stream_->alive());
  }
}

TEST_F(LibusbStreamTest, TransfersWaitForBytesWithoutPolling) {
  EXPECT_EQ(device_->waiting_in(), 4u);
  std::array<std::uint8_t, 10> bytes{};
  EXPECT_EQ(stream_->read(bytes), 0u);
  const std::size_t polls = device_->polls();
  const Clock::time_point begin = Clock::now();
  stream_->wait(milliseconds(200));
  EXPECT_GE(Clock::now() - begin, milliseconds(200)) << "returned without data";
  EXPECT_LE(device_->polls() - polls, 3u) << "must wait in poll()";
  EXPECT_EQ(device_->waiting_in(), 4u);
  EXPECT_TRUE(stream_->alive());
  // Arriving bytes end the wait, and the transfer is submitted again.
  std::jthread later([&] {
    std::this_thread::sleep_for(milliseconds(50));
    give_all({1, 2, 3});
  });
  stream_->wait(std::chrono::duration_cast<microseconds>(3 * long_time));
  EXPECT_LT(Clock::now() - begin, long_time);
  EXPECT_EQ(stream_->read(bytes), 3u);
  EXPECT_EQ(bytes[2], 3);
  EXPECT_EQ(device_->waiting_in(), 4u);
}

TEST_F(LibusbStreamTest, AWaitIsOverWhileSomethingIsLeftToRead) {
  give_all({1, 2, 3});
  std::array<std::uint8_t, 2> bytes{};
  stream_->wait(milliseconds(100));
  EXPECT_EQ(stream_->read(bytes), 2u);
  const Clock::time_point begin = Clock::now();
  stream_->wait(std::chrono::duration_cast<microseconds>(long_time));
  EXPECT_LT(Clock::now() - begin, long_time / 2);
  EXPECT_EQ(stream_->read(bytes), 1u);
}

/// An empty packet ends a transfer of no bytes.
TEST_F(LibusbStreamTest, AnswersOfWholePacketsArrive) {
  for (const std::size_t size : {64u, 1'024u, 1'088u, 4'096u}) {
    const Bytes sent = random_bytes(size, random_);
    give_all(sent);
    EXPECT_TRUE(read_all(size) == sent) << size;
  }
}

TEST_F(LibusbStreamTest, ADeviceWaitsForAHostThatDoesNotRead) {
  const Bytes sent = random_bytes(3 * kept, random_);
  std::size_t given = 0;
  const auto give = [&] { given += device_->give(std::span(sent).subspan(given)); };
  for (int i = 0; i < 500; ++i) {
    give();
    stream_->wait({});
    EXPECT_EQ(stream_->write({}), 0u);
  }
  EXPECT_GE(given, kept);
  EXPECT_LE(given, kept + queued);
  EXPECT_EQ(device_->waiting_in(), 0u);
  Bytes received(sent.size());
  std::size_t count = 0;
  EXPECT_TRUE(holds_soon([&] {
    give();
    const std::size_t wish = std::min(received.size() - count, between(1, 20'000, random_));
    count += stream_->read(std::span(received).subspan(count, wish));
    return count == sent.size();
  }));
  EXPECT_TRUE(received == sent);
  EXPECT_TRUE(stream_->alive());
}

TEST_F(LibusbStreamTest, AHostWaitsForADeviceThatDoesNotRead) {
  const Bytes sent = random_bytes(10'000, random_);
  EXPECT_EQ(stream_->write(sent), queued);
  EXPECT_EQ(stream_->write(std::span(sent).subspan(queued)), 0u);
  EXPECT_EQ(device_->waiting_out(), 4u);
  // Half a transfer makes no room; a whole one does.
  Bytes taken = take_all(500);
  EXPECT_EQ(stream_->write(std::span(sent).subspan(queued)), 0u);
  const Bytes rest = take_all(524);
  EXPECT_EQ(stream_->write(std::span(sent).subspan(queued)), 1'024u);
  const Bytes last = take_all(queued);
  for (const Bytes& more : {rest, last}) taken.insert(taken.end(), more.begin(), more.end());
  EXPECT_TRUE(std::equal(taken.begin(), taken.end(), sent.begin()));
  EXPECT_TRUE(stream_->alive());
}

/// The errors of an unplugged device from host controller, hub and kernel.
class LibusbStreamEnds : public LibusbStreamTest, public testing::WithParamInterface<int> {};

TEST_P(LibusbStreamEnds, AnUnpluggedDeviceIsReported) {
  EXPECT_EQ(stream_->write(random_bytes(2'000, random_)), 2'000u);
  give_all({7, 8, 9});
  device_->unplug(GetParam());
  const Clock::time_point begin = Clock::now();
  for (int i = 0; i < 10; ++i) stream_->wait(std::chrono::duration_cast<microseconds>(long_time));
  EXPECT_LT(Clock::now() - begin, long_time) << "a wait is over when the device is gone";
  EXPECT_FALSE(stream_->alive());
  EXPECT_EQ(stream_->write(random_bytes(10, random_)), 0u);
  std::array<std::uint8_t, 10> bytes{};
  EXPECT_EQ(stream_->read(bytes), 3u) << "bytes that had arrived can still be read";
  EXPECT_EQ(stream_->read(bytes), 0u);
  EXPECT_FALSE(stream_->alive());
}

INSTANTIATE_TEST_SUITE_P(OfTheKernel, LibusbStreamEnds,
                         testing::Values(-ENODEV, -ESHUTDOWN, -EPROTO, -EILSEQ, -ENOENT));

/// Before the hub has noticed that the device is gone.
TEST_F(LibusbStreamTest, FailedTransfersEndTheStream) {
  for (const int status : {-ESHUTDOWN, -EPROTO, -EILSEQ, -EOVERFLOW}) {
    stream_ = open_->stream(out_endpoint, in_endpoint);
    device_->fail(status);
    stream_->wait(milliseconds(100));
    EXPECT_FALSE(stream_->alive()) << status;
    EXPECT_EQ(stream_->write(random_bytes(10, random_)), 0u) << status;
    stream_.reset();
    device_->fail(0);
  }
}

TEST_F(LibusbStreamTest, UnpluggingEndsAWait) {
  std::jthread later([&] {
    std::this_thread::sleep_for(milliseconds(50));
    device_->unplug(-ESHUTDOWN);
  });
  const Clock::time_point begin = Clock::now();
  stream_->wait(std::chrono::duration_cast<microseconds>(long_time));
  EXPECT_LT(Clock::now() - begin, long_time / 2);
  EXPECT_FALSE(stream_->alive());
}

TEST_F(LibusbStreamTest, AStalledEndpointEndsTheStream) {
  device_->halt(true, -EPIPE);
  stream_->wait(milliseconds(100));
  EXPECT_FALSE(stream_->alive());
  stream_ = open_->stream(out_endpoint, in_endpoint);
  stream_->wait(milliseconds(100));
  EXPECT_FALSE(stream_->alive()) << "it is still halted";
}

/// Refused, or cancelled by the kernel, which libusb reports as done: fewer bytes were sent than
/// written.
TEST_F(LibusbStreamTest, BytesThatAreNotSentEndTheStream) {
  for (const int status : {-EPIPE, -ENOENT}) {
    stream_ = open_->stream(out_endpoint, in_endpoint);
    device_->halt(false, status);
    EXPECT_TRUE(stream_->alive()) << "nothing was sent yet";
    EXPECT_EQ(stream_->write(random_bytes(100, random_)), 100u);
    EXPECT_TRUE(holds_soon([&] {
      stream_->wait(milliseconds(10));
      return !stream_->alive();
    })) << status;
    stream_.reset();
    device_->halt(false, 0);
  }
}

TEST_F(LibusbStreamTest, AcceptedBytesAreStillSent) {
  const Bytes sent = random_bytes(queued, random_);
  ASSERT_EQ(stream_->write(sent), sent.size());
  std::jthread board([&] {
    std::this_thread::sleep_for(milliseconds(20));
    const Bytes taken = take_all(queued);
    EXPECT_TRUE(taken == sent);
  });
  stream_.reset();
  EXPECT_EQ(device_->owed(), 0u);
  board.join();
}

TEST_F(LibusbStreamTest, EndsWithTransfersThatAreNeverRead) {
  for (int round = 0; round < scaled(5); ++round) {
    ASSERT_EQ(stream_->write(random_bytes(queued, random_)), queued);
    device_->give(random_bytes(2'000, random_));
    EXPECT_GT(device_->owed(), 4u);
    const Clock::time_point begin = Clock::now();
    stream_.reset();
    EXPECT_LT(Clock::now() - begin, long_time / 2);
    EXPECT_EQ(device_->owed(), 0u);
    EXPECT_EQ(device_->waiting_out(), 0u);
    stream_ = open_->stream(out_endpoint, in_endpoint);
    EXPECT_EQ(device_->waiting_in(), 4u);
  }
}

}  // namespace
}  // namespace lamplock::usb
