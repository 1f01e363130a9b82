// USB serial port: requests by golden bytes of USB 2.0 (chapter 9), CDC 1.2 and PSTN 1.2; the pipes
// by faults that must never happen to bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <random>
#include <string>

#include "tests/board_rp2040/fake_usb.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

using rp2040::UsbCounters;

// bmRequestType.
constexpr std::uint8_t to_host = 0x80;
constexpr std::uint8_t interface_in = 0x81;
constexpr std::uint8_t interface_out = 0x01;
constexpr std::uint8_t endpoint_in = 0x82;
constexpr std::uint8_t endpoint_out = 0x02;
constexpr std::uint8_t class_in = 0xA1;
constexpr std::uint8_t class_out = 0x21;

std::string text(const Bytes& string_descriptor) {
  std::string out;
  for (std::size_t i = 2; i + 1 < string_descriptor.size(); i += 2) {
    EXPECT_EQ(string_descriptor[i + 1], 0);
    out += static_cast<char>(string_descriptor[i]);
  }
  return out;
}

TEST(UsbControl, EnumeratesLikeLinux) {
  UsbHost host;
  EXPECT_TRUE(host.usb.started && host.usb.attached);
  host.serial.set_serial_number("E6605838832A1B2C");
  host.reset();
  const auto first = host.control(to_host, 6, 0x0100, 0, 64);
  const Bytes device = {18,   1,    0x01, 0x02, 0xEF, 0x02, 0x01, 64, 0x09,
                        0x12, 0x01, 0x00, 0x12, 0x00, 1,    2,    3,  1};
  EXPECT_EQ(first.data, device);
  host.reset();
  ASSERT_EQ(host.control(0, 5, 42, 0, 0).handshake, Handshake::ack);
  EXPECT_EQ(host.usb.address, 42);
  EXPECT_EQ(host.control(to_host, 6, 0x0100, 0, 18).data, device);
  EXPECT_EQ(host.control(to_host, 6, 0x0600, 0, 10).handshake, Handshake::stall);
  const auto head = host.control(to_host, 6, 0x0200, 0, 9);
  EXPECT_EQ(head.data, (Bytes{9, 2, 98, 0, 3, 1, 0, 0x80, 50}));
  const Bytes configuration = {9, 2,    98,   0,    3,    1,    0,  0x80, 50,  // configuration
                               8, 11,   0,    2,    2,    2,    0,  4,         // association
                               9, 4,    0,    0,    1,    2,    2,  0,    4,   // control interface
                               5, 0x24, 0,    0x10, 0x01,                      // header
                               5, 0x24, 1,    0,    1,                         // call management
                               4, 0x24, 2,    6,                               // abstract control
                               5, 0x24, 6,    0,    1,                         // union
                               7, 5,    0x81, 3,    16,   0,    16,            // notification
                               9, 4,    1,    0,    2,    0x0A, 0,  0,    0,   // data interface
                               7, 5,    0x02, 2,    64,   0,    0,             // OUT
                               7, 5,    0x82, 2,    64,   0,    0,             // IN
                               9, 4,    2,    0,    2,    0xFF, 0,  0,    5,   // pulse stream
                               7, 5,    0x03, 2,    64,   0,    0,             // OUT
                               7, 5,    0x83, 2,    64,   0,    0};            // IN
  EXPECT_EQ(host.control(to_host, 6, 0x0200, 0, 98).data, configuration);
  EXPECT_EQ(host.control(to_host, 6, 0x0300, 0, 255).data, (Bytes{4, 3, 9, 4}));
  EXPECT_EQ(text(host.control(to_host, 6, 0x0301, 0x0409, 255).data), "lamplock");
  EXPECT_EQ(text(host.control(to_host, 6, 0x0302, 0x0409, 255).data), "lamplock pico");
  EXPECT_EQ(text(host.control(to_host, 6, 0x0303, 0x0409, 255).data), "E6605838832A1B2C");
  EXPECT_EQ(text(host.control(to_host, 6, 0x0305, 0x0409, 255).data), "lamplock pulse stream");
  EXPECT_EQ(host.control(to_host, 8, 0, 0, 1).data, Bytes{0});
  EXPECT_FALSE(host.serial.configured());
  ASSERT_EQ(host.control(0, 9, 1, 0, 0).handshake, Handshake::ack);
  EXPECT_TRUE(host.serial.configured());
  EXPECT_EQ(host.control(to_host, 8, 0, 0, 1).data, Bytes{1});
  EXPECT_EQ(host.serial.counters().refused_requests, 1u);
}

TEST(UsbControl, WindowsAndMacAskDifferently) {
  UsbHost host;
  host.reset();
  EXPECT_EQ(host.control(to_host, 6, 0x0100, 0, 8).data.size(), 8u);  // macOS: first 8 bytes
  ASSERT_EQ(host.control(0, 5, 1, 0, 0).handshake, Handshake::ack);
  EXPECT_EQ(host.control(to_host, 6, 0x0200, 0, 255).data.size(), 98u);
  EXPECT_EQ(host.control(to_host, 6, 0x03EE, 0, 18).handshake, Handshake::stall);  // Microsoft
  EXPECT_EQ(host.control(to_host, 6, 0x0303, 0x0407, 255).handshake, Handshake::stall);
  EXPECT_EQ(host.control(to_host, 6, 0x0302, 0x0409, 2).data.size(), 2u);
}

// Specification of Microsoft OS 2.0 descriptors, tables 4 and 10 to 14; byte by byte.
TEST(UsbControl, ReportsWinUsbToWindows) {
  UsbHost host;
  host.reset();
  const Bytes bos = {5,    15,   33,   0,    1,                                   // header
                     28,   16,   5,    0,                                         // platform
                     0xDF, 0x60, 0xDD, 0xD8, 0x89, 0x45, 0xC7, 0x4C, 0x9C, 0xD2,  // UUID
                     0x65, 0x9D, 0x9E, 0x64, 0x8A, 0x9F, 0x00, 0x00, 0x03, 0x06,  // 8.1
                     178,  0,    0x4D, 0};
  Bytes set = {10,  0, 0, 0, 0x00, 0x00, 0x03, 0x06, 178, 0,          // set header
               8,   0, 1, 0, 0,    0,    168,  0,                     // configuration subset
               8,   0, 2, 0, 2,    0,    160,  0,                     // function subset
               20,  0, 3, 0, 'W',  'I',  'N',  'U',  'S', 'B', 0, 0,  // compatible ID
               0,   0, 0, 0, 0,    0,    0,    0,                     // sub-ID
               132, 0, 4, 0, 7,    0,    42,   0};                    // registry property
  const auto wide = [&set](std::string_view ascii, std::size_t zeros) {
    for (const char c : ascii) set.insert(set.end(), {static_cast<std::uint8_t>(c), 0});
    set.insert(set.end(), 2 * zeros, 0);
  };
  wide("DeviceInterfaceGUIDs", 1);
  set.insert(set.end(), {80, 0});
  wide("{DF884B5E-C1E3-4649-AAC9-FCBA261F5FF0}", 2);
  for (const bool configured : {false, true}) {
    if (configured) {
      ASSERT_TRUE(host.enumerate());
    }
    EXPECT_EQ(host.control(to_host, 6, 0x0F00, 0, 5).data, Bytes(bos.begin(), bos.begin() + 5));
    EXPECT_EQ(host.control(to_host, 6, 0x0F00, 0, 33).data, bos);
    EXPECT_EQ(host.control(to_host, 6, 0x0F00, 0, 255).data, bos);
    EXPECT_EQ(host.control(0xC0, 0x4D, 0, 7, 178).data, set);
    EXPECT_EQ(host.control(0xC0, 0x4D, 0, 7, 10).data, Bytes(set.begin(), set.begin() + 10));
    EXPECT_EQ(host.control(0xC0, 0x4D, 0, 7, 4096).data, set);
  }
}

// Windows stores the properties of a version, so a version must not change.
TEST(UsbControl, ChangedDescriptorsHaveANewVersion) {
  UsbHost host;
  host.reset();
  std::uint64_t sum = 14'695'981'039'346'656'037u;  // FNV-1a, 64 bits
  const auto add = [&sum](const Bytes& bytes) {
    for (const std::uint8_t byte : bytes) sum = (sum ^ byte) * 1'099'511'628'211u;
  };
  Bytes device = host.control(to_host, 6, 0x0100, 0, 18).data;
  ASSERT_EQ(device.size(), 18u);
  const int version = device[12] | device[13] << 8;
  device[12] = device[13] = 0;
  add(device);
  add(host.control(to_host, 6, 0x0200, 0, 255).data);
  add(host.control(to_host, 6, 0x0F00, 0, 255).data);
  add(host.control(0xC0, 0x4D, 0, 7, 4096).data);
  EXPECT_EQ(version, 0x0012);
  EXPECT_EQ(sum, 10'939'475'691'639'477'757u)
      << "raise device_version, then write both numbers here";
}

TEST(UsbControl, AddressTakesEffectAfterTheStatusStage) {
  UsbHost host;
  host.reset();
  host.usb.setup(UsbHost::packet(0, 5, 99, 0, 0));
  host.serve();
  EXPECT_EQ(host.usb.address, 0);
  Bytes data;
  bool data1 = false;
  ASSERT_EQ(host.usb.in(0, data, data1), Handshake::ack);
  host.serve();
  EXPECT_EQ(host.usb.address, 99);
  host.reset();
  EXPECT_EQ(host.usb.address, 0);
}

/// One request and its expected result; `data` of the requests that are answered.
struct Case {
  std::uint8_t type, request;
  std::uint16_t value, index, length;
  bool address_state, configured_state;  ///< answered in that state
  Bytes data{};
};

TEST(UsbControl, EveryRequestInEveryState) {
  const Case cases[] = {
      // GET_STATUS: device, interfaces, endpoints (9.4.5).
      {to_host, 0, 0, 0, 2, true, true, {0, 0}},
      {to_host, 0, 1, 0, 2, false, false},
      {interface_in, 0, 0, 0, 2, false, true, {0, 0}},
      {interface_in, 0, 0, 1, 2, false, true, {0, 0}},
      {interface_in, 0, 0, 2, 2, false, true, {0, 0}},
      {interface_in, 0, 0, 3, 2, false, false},
      {endpoint_in, 0, 0, 0x00, 2, true, true, {0, 0}},
      {endpoint_in, 0, 0, 0x80, 2, true, true, {0, 0}},
      {endpoint_in, 0, 0, 0x81, 2, false, true, {0, 0}},
      {endpoint_in, 0, 0, 0x82, 2, false, true, {0, 0}},
      {endpoint_in, 0, 0, 0x02, 2, false, true, {0, 0}},
      {endpoint_in, 0, 0, 0x01, 2, false, false},
      {endpoint_in, 0, 0, 0x03, 2, false, true, {0, 0}},
      {endpoint_in, 0, 0, 0x83, 2, false, true, {0, 0}},
      {endpoint_in, 0, 0, 0x84, 2, false, false},
      // CLEAR_FEATURE, SET_FEATURE (9.4.1, 9.4.9).
      {0x00, 1, 1, 0, 0, false, false},  // remote wake-up
      {0x00, 3, 1, 0, 0, false, false},
      {0x00, 3, 2, 0x0100, 0, false, false},  // test mode
      {endpoint_out, 1, 0, 0x00, 0, true, true},
      {endpoint_out, 1, 0, 0x82, 0, false, true},
      {endpoint_out, 1, 0, 0x02, 0, false, true},
      {endpoint_out, 1, 0, 0x81, 0, false, true},
      {endpoint_out, 1, 0, 0x03, 0, false, true},
      {endpoint_out, 1, 0, 0x83, 0, false, true},
      {endpoint_out, 1, 1, 0x82, 0, false, false},
      {endpoint_out, 1, 0, 0x84, 0, false, false},
      {endpoint_out, 3, 0, 0x00, 0, false, false},
      {interface_out, 3, 0, 0, 0, false, false},
      // SET_ADDRESS (9.4.6).
      {0x00, 5, 5, 0, 0, true, false},
      {0x00, 5, 128, 0, 0, false, false},
      {0x00, 5, 5, 1, 0, false, false},
      // GET_DESCRIPTOR, SET_DESCRIPTOR (9.4.3, 9.4.8).
      {to_host, 6, 0x0101, 0, 18, false, false},
      {to_host, 6, 0x0201, 0, 9, false, false},
      {to_host, 6, 0x0306, 0x0409, 255, false, false},
      {to_host, 6, 0x0F01, 0, 5, false, false},
      {to_host, 6, 0x0F00, 1, 5, false, false},
      {to_host, 6, 0x0400, 0, 9, false, false},
      {to_host, 6, 0x0700, 0, 9, false, false},
      {0x00, 7, 0x0100, 0, 18, false, false},
      // GET_CONFIGURATION, SET_CONFIGURATION (9.4.2, 9.4.7).
      {to_host, 8, 0, 1, 1, false, false},
      {0x00, 9, 2, 0, 0, false, false},
      {0x00, 9, 0x0101, 0, 0, false, false},
      // GET_INTERFACE, SET_INTERFACE, SYNCH_FRAME (9.4.4, 9.4.10, 9.4.11).
      {interface_in, 10, 0, 0, 1, false, true, {0}},
      {interface_in, 10, 0, 1, 1, false, true, {0}},
      {interface_in, 10, 0, 2, 1, false, true, {0}},
      {interface_in, 10, 0, 3, 1, false, false},
      {interface_out, 11, 0, 0, 0, false, true},
      {interface_out, 11, 0, 1, 0, false, true},
      {interface_out, 11, 0, 2, 0, false, true},
      {interface_out, 11, 1, 1, 0, false, false},
      {endpoint_in, 12, 0, 0x82, 2, false, false},
      // Abstract control model (PSTN 1.2, 6.3).
      {class_in, 0x21, 0, 0, 7, false, true, {0x00, 0xC2, 0x01, 0x00, 0, 0, 8}},
      {class_in, 0x21, 0, 1, 7, false, false},
      {class_out, 0x22, 3, 0, 0, false, true},
      {class_out, 0x22, 3, 1, 0, false, false},
      {class_out, 0x23, 0xffff, 0, 0, false, true},
      {class_out, 0x00, 0, 0, 0, false, false},  // SEND_ENCAPSULATED_COMMAND
      {class_in, 0x01, 0, 0, 8, false, false},
      {class_out, 0x20, 0, 0, 0, false, false},  // without its data
      {0x20, 0x22, 3, 0, 0, false, false},       // to the device
      {0x40, 0, 0, 0, 0, false, false},          // vendor
      {0xC0, 0x20, 0, 4, 16, false, false},
      {0xC0, 0x4D, 0, 8, 178, false, false},  // SET_ALT_ENUMERATION, not announced
      {0xC0, 0x4D, 1, 7, 178, false, false},
      {0xC1, 0x4D, 0, 7, 178, false, false},
      {0x40, 0x4D, 0, 7, 0, false, false},
      {0x60, 0, 0, 0, 0, false, false},
      {0x03, 0, 0, 0, 0, false, false},
  };
  for (const bool configured : {false, true}) {
    for (const Case& request : cases) {
      SCOPED_TRACE(testing::Message() << "type " << int(request.type) << " request "
                                      << int(request.request) << " value " << request.value
                                      << " index " << request.index << (configured ? " conf" : ""));
      UsbHost host;
      host.reset();
      ASSERT_EQ(host.control(0, 5, 3, 0, 0).handshake, Handshake::ack);
      if (configured) {
        ASSERT_EQ(host.control(0, 9, 1, 0, 0).handshake, Handshake::ack);
      }
      const auto result =
          host.control(request.type, request.request, request.value, request.index, request.length);
      const bool answered = configured ? request.configured_state : request.address_state;
      EXPECT_EQ(result.handshake, answered ? Handshake::ack : Handshake::stall);
      if (answered) {
        EXPECT_EQ(result.data, request.data);
      }
      // A refusal ends with the next request.
      EXPECT_EQ(host.control(to_host, 8, 0, 0, 1).data,
                Bytes{configured ? std::uint8_t{1} : std::uint8_t{0}});
    }
  }
}

TEST(UsbControl, LengthsAndEmptyPackets) {
  UsbHost host;
  host.reset();
  const Bytes whole = host.control(to_host, 6, 0x0200, 0, 255).data;
  for (std::uint16_t length = 1; length <= 200; ++length) {
    const Bytes part = host.control(to_host, 6, 0x0200, 0, length).data;
    ASSERT_EQ(part.size(), std::min<std::size_t>(length, whole.size()));
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin()));
  }
  // No data stage at all: status to the host.
  EXPECT_EQ(host.control(to_host, 6, 0x0100, 0, 0).handshake, Handshake::ack);
}

// No descriptor is a multiple of 64 bytes, so the rule is tested on the pipe itself.
TEST(UsbControl, AnEmptyPacketEndsWholePacketsShorterThanRequested) {
  struct Requests {
    Bytes reply;
    rp2040::usb::Reaction setup(const rp2040::usb::SetupPacket&) const {
      return {rp2040::usb::Answer::send, rp2040::usb::Effect::none, 0, reply};
    }
    bool received(std::span<const std::uint8_t>) const { return false; }
    std::uint8_t address() const { return 0; }
  };
  for (const std::size_t size : {0u, 1u, 63u, 64u, 65u, 128u, 192u}) {
    for (const std::uint16_t asked : std::array<std::uint16_t, 7>{1, 63, 64, 65, 128, 129, 255}) {
      SCOPED_TRACE(testing::Message() << size << " bytes, asked for " << asked);
      FakeUsb usb;
      Requests requests{numbered(size)};
      rp2040::usb::ControlPipe<FakeUsb, Requests> pipe(usb, requests);
      usb.setup(UsbHost::packet(to_host, 6, 0, 0, asked));
      pipe.on_setup([](const rp2040::usb::Reaction&) {});
      std::vector<std::size_t> packets;
      Bytes data;
      bool data1 = false;
      while (usb.in(0, data, data1) == Handshake::ack) {
        EXPECT_EQ(data1, packets.size() % 2 == 0);
        packets.push_back(data.size());
        pipe.on_in_done();
      }
      std::vector<std::size_t> expected;
      std::size_t left = std::min<std::size_t>(size, asked);
      for (; left >= 64; left -= 64) expected.push_back(64);
      if (left != 0 || size < asked) expected.push_back(left);
      EXPECT_EQ(packets, expected);
      EXPECT_EQ(usb.out(0, true, {}), Handshake::ack);
    }
  }
}

TEST(UsbControl, HostMayEndTheDataStageEarly) {
  UsbHost host;
  host.reset();
  host.usb.setup(UsbHost::packet(to_host, 6, 0x0200, 0, 75));
  host.serve();
  EXPECT_EQ(host.usb.out(0, true, {}), Handshake::ack);
  host.serve();
  Bytes data;
  bool data1 = false;
  EXPECT_EQ(host.usb.in(0, data, data1), Handshake::nak);
  EXPECT_EQ(host.control(to_host, 6, 0x0100, 0, 18).data.size(), 18u);
}

/// A host that has configured the device.
struct UsbConfigured : testing::Test {
  void SetUp() override { ASSERT_TRUE(host.enumerate()); }
  /// The main loop polls, which makes the interrupt poll again.
  void poll() {
    host.serial.poll();
    host.serve();
  }
  UsbHost host;
};

TEST_F(UsbConfigured, LineCodingIsStoredWithoutOtherEffects) {
  const Bytes coding = {0xB0, 0x04, 0, 0, 0, 0, 8};  // 1200 baud
  EXPECT_EQ(host.control(class_out, 0x20, 0, 0, 7, coding).handshake, Handshake::ack);
  EXPECT_EQ(host.control(class_in, 0x21, 0, 0, 7).data, coding);
  EXPECT_EQ(host.control(class_in, 0x21, 0, 0, 64).data, coding);
  EXPECT_EQ(host.control(class_in, 0x21, 0, 0, 3).data, Bytes(coding.begin(), coding.begin() + 3));
  const std::uint32_t generation = host.serial.generation();
  for (const std::uint16_t lines : std::array<std::uint16_t, 6>{3, 0, 1, 2, 0, 3})
    host.control(class_out, 0x22, lines, 0, 0);
  EXPECT_EQ(host.serial.opened(), 3u);
  EXPECT_TRUE(host.serial.dtr());
  EXPECT_EQ(host.serial.generation(), generation);
  EXPECT_TRUE(host.serial.configured());
  EXPECT_EQ(host.usb.address, 7);
  ASSERT_EQ(host.control(0, 9, 1, 0, 0).handshake, Handshake::ack);
  EXPECT_FALSE(host.serial.dtr());
  // Data of the wrong length: refused, the old ones stay.
  EXPECT_EQ(host.control(class_out, 0x20, 0, 0, 8, numbered(8)).handshake, Handshake::stall);
  EXPECT_EQ(host.control(class_out, 0x20, 0, 0, 7, numbered(5)).handshake, Handshake::stall);
  EXPECT_EQ(host.control(class_in, 0x21, 0, 0, 7).data, coding);
}

/// Presence of a host program while the port is open, closed or asleep.
TEST(UsbControl, AHostIsPresentUntilItClosesThePort) {
  UsbHost host;
  const auto lines = [&host](std::uint16_t value) { host.control(class_out, 0x22, value, 0, 0); };
  struct Event {
    const char* what;
    std::function<void()> happens;
    bool present;
  };
  const std::vector<Event> events{
      {"power-up", [] {}, false},
      {"configured by a program that never raises DTR", [&] { host.enumerate(); }, true},
      {"DTR and RTS", [&] { lines(3); }, true},
      {"closed", [&] { lines(0); }, false},
      {"DTR", [&] { lines(1); }, true},
      {"suspended", [&] { host.usb.suspend(), host.serve(); }, false},
      {"resumed", [&] { host.usb.resume(), host.serve(); }, true},
      {"reset", [&] { host.reset(); }, false}};
  for (const Event& event : events) {
    event.happens();
    EXPECT_EQ(host.serial.present(), event.present) << event.what;
  }
}

class UsbFunctions : public testing::TestWithParam<std::uint8_t> {
 protected:
  /// A host that uses one of the functions.
  UsbFunctions() { host_.endpoint = GetParam(); }
  /// The OUT and IN endpoint of the function.
  std::uint8_t out() const { return GetParam(); }
  std::uint8_t in() const { return 0x80 | GetParam(); }
  /// Sends a line so that this function becomes active.
  void speak() {
    ASSERT_EQ(host_.bulk_out(numbered(1)), Handshake::ack);
    ASSERT_EQ(read_all(host_), numbered(1));
  }
  UsbHost host_;
};
INSTANTIATE_TEST_SUITE_P(Endpoints, UsbFunctions, testing::Values(2, 3),
                         [](const auto& param_info) {
                           return param_info.param == 2 ? "SerialPort" : "PulseStream";
                         });

TEST_P(UsbFunctions, HaltAndItsEnd) {
  ASSERT_TRUE(host_.enumerate());
  // One packet each way, so that toggles and turns are odd.
  ASSERT_EQ(host_.bulk_out(numbered(5)), Handshake::ack);
  host_.serial.write(numbered(3));
  host_.serve();
  ASSERT_EQ(host_.bulk_in().data, numbered(3));
  host_.serial.write(numbered(70, 5));
  host_.serve();
  for (const std::uint16_t endpoint : std::array<std::uint16_t, 3>{out(), in(), 0x81}) {
    EXPECT_EQ(host_.control(endpoint_out, 3, 0, endpoint, 0).handshake, Handshake::ack);
    EXPECT_EQ(host_.control(endpoint_in, 0, 0, endpoint, 2).data, (Bytes{1, 0}));
  }
  EXPECT_EQ(host_.bulk_out(numbered(5)), Handshake::stall);
  EXPECT_EQ(host_.bulk_in().handshake, Handshake::stall);
  Bytes none;
  bool data1 = false;
  EXPECT_EQ(host_.usb.in(1, none, data1), Handshake::stall);
  for (const std::uint16_t endpoint : std::array<std::uint16_t, 3>{out(), in(), 0x81}) {
    EXPECT_EQ(host_.control(endpoint_out, 1, 0, endpoint, 0).handshake, Handshake::ack);
    EXPECT_EQ(host_.control(endpoint_in, 0, 0, endpoint, 2).data, (Bytes{0, 0}));
  }
  host_.clear_toggles();
  EXPECT_EQ(host_.usb.in(1, none, data1), Handshake::nak);
  Bytes got;
  for (int i = 0; i < 3; ++i) {
    const auto packet = host_.bulk_in();
    got.insert(got.end(), packet.data.begin(), packet.data.end());
  }
  EXPECT_EQ(got, numbered(70, 5));
  for (unsigned i = 0; i < 5; ++i) ASSERT_EQ(host_.bulk_out(numbered(64, i)), Handshake::ack);
  EXPECT_EQ(read_all(host_).size(), 5u + 5 * 64u);
  EXPECT_EQ(host_.usb.sequence_errors, 0);
  EXPECT_EQ(host_.serial.counters().resynchronised, 0u);
}

TEST_P(UsbFunctions, ClearFeatureAndSetInterfaceRestartToggles) {
  for (const bool by_interface : {false, true}) {
    ASSERT_TRUE(host_.enumerate());
    Bytes sent;
    for (unsigned round = 0; round < 9; ++round) {
      for (unsigned i = 0; i <= round % 3; ++i) {
        const Bytes packet = numbered(10 + round, i);
        ASSERT_EQ(host_.bulk_out(packet), Handshake::ack);
        sent.insert(sent.end(), packet.begin(), packet.end());
        host_.serial.write(packet);
        host_.serve();
        ASSERT_EQ(host_.bulk_in().data, packet);
      }
      if (by_interface) {
        ASSERT_EQ(host_.control(interface_out, 11, 0, out() - 1, 0).handshake, Handshake::ack);
      } else {
        ASSERT_EQ(host_.control(endpoint_out, 1, 0, out(), 0).handshake, Handshake::ack);
        ASSERT_EQ(host_.control(endpoint_out, 1, 0, in(), 0).handshake, Handshake::ack);
      }
      host_.clear_toggles();
    }
    EXPECT_EQ(read_all(host_), sent);
    EXPECT_EQ(host_.usb.sequence_errors, 0);
  }
}

TEST(UsbControl, AnUnusedConnectionMayBeRestarted) {
  UsbHost host;
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(host.enumerate());
    // The controller is left at buffer 1 each time.
    host.serial.write(numbered(3));
    ASSERT_EQ(host.control(endpoint_out, 1, 0, 0x02, 0).handshake, Handshake::ack);
    ASSERT_EQ(host.control(endpoint_out, 1, 0, 0x82, 0).handshake, Handshake::ack);
    host.clear_toggles();
    ASSERT_EQ(host.bulk_in().data, numbered(3));
    ASSERT_EQ(host.bulk_out(numbered(4)), Handshake::ack);
    ASSERT_EQ(read_all(host), numbered(4));
  }
  EXPECT_EQ(host.serial.counters().resynchronised, 0u);
}

TEST_F(UsbConfigured, GarbageNeverBlocksIt) {
  std::mt19937_64 random(20260);
  for (int round = 0; round < scaled(20000); ++round) {
    std::array<std::uint8_t, 8> setup{};
    for (auto& byte : setup) byte = static_cast<std::uint8_t>(random());
    if (random() % 2 == 0) {  // near misses
      setup[0] = std::array<std::uint8_t, 8>{0, 1, 2, 0x80, 0x81, 0x82, 0x21, 0xA1}[random() % 8];
      setup[1] = static_cast<std::uint8_t>(random() % 2 == 0 ? random() % 13 : 0x20 + random() % 4);
      for (const std::size_t i : {2u, 4u, 6u}) setup[i] = static_cast<std::uint8_t>(random() % 8);
      for (const std::size_t i : {3u, 5u, 7u}) setup[i] = static_cast<std::uint8_t>(random() % 4);
    }
    host.usb.setup(setup);
    if (random() % 8 != 0) host.serve();
    // Some random tokens, as from a faulty host.
    for (std::uint64_t i = random() % 4; i > 0; --i) {
      Bytes data(random() % 65);
      bool data1 = random() % 2 == 0;
      const auto endpoint = static_cast<std::uint8_t>(random() % 4);
      if (random() % 2 == 0) {
        host.usb.in(endpoint, data, data1);
      } else if (data.size() <= 64) {
        host.usb.out(endpoint, data1, data);
      }
      if (random() % 4 != 0) host.serve();
    }
    host.serve();
    if (random() % 16 == 0) {
      ASSERT_EQ(host.control(to_host, 6, 0x0100, 0, 18).data.size(), 18u);
    }
    if (random() % 64 == 0) {
      ASSERT_TRUE(host.enumerate());
      const Bytes packet = numbered(1 + random() % 64);
      ASSERT_EQ(host.bulk_out(packet), Handshake::ack);
      ASSERT_EQ(read_all(host), packet);
      host.serial.write(packet);
      host.serve();
      ASSERT_EQ(host.bulk_in().data, packet);
    }
  }
}

TEST_P(UsbFunctions, BytesArriveOnceAndInOrder) {
  std::mt19937_64 random(7);
  ASSERT_TRUE(host_.enumerate());
  ASSERT_NO_FATAL_FAILURE(speak());
  Bytes to_device, at_device, to_host_bytes, at_host;
  for (int round = 0; round < scaled(20000); ++round) {
    if (random() % 32 == 0) host_.frame(static_cast<std::uint32_t>(random() % 800));
    const auto in_size = static_cast<std::size_t>(random() % 3 == 0 ? 64 : random() % 65);
    if (host_.serial.available() + in_size < 3000) {
      const Bytes packet = numbered(in_size, static_cast<unsigned>(random() % 26));
      // The device may not have polled since the last packet: there are two buffers.
      const Handshake answer = host_.bulk_out(packet, random() % 3 != 0);
      if (answer == Handshake::ack)
        to_device.insert(to_device.end(), packet.begin(), packet.end());
      else
        host_.serve();
    }
    if (random() % 4 == 0) {
      Bytes buffer(random() % 300);
      const std::size_t count = host_.serial.read(buffer);
      at_device.insert(at_device.end(), buffer.begin(),
                       buffer.begin() + static_cast<std::ptrdiff_t>(count));
    }
    const Bytes out = numbered(random() % 100, static_cast<unsigned>(random() % 26));
    const std::size_t room = host_.serial.room();
    const std::size_t taken = host_.serial.write(out);
    ASSERT_EQ(taken, std::min(out.size(), room));
    to_host_bytes.insert(to_host_bytes.end(), out.begin(),
                         out.begin() + static_cast<std::ptrdiff_t>(taken));
    if (random() % 2 == 0) host_.serve();
    for (std::uint64_t i = random() % 4; i > 0; --i) {
      const auto packet = host_.bulk_in(random() % 2 == 0);
      at_host.insert(at_host.end(), packet.data.begin(), packet.data.end());
    }
  }
  host_.frame();
  for (int i = 0; i < 200; ++i) {
    const auto packet = host_.bulk_in();
    at_host.insert(at_host.end(), packet.data.begin(), packet.data.end());
  }
  const Bytes rest = read_all(host_);
  at_device.insert(at_device.end(), rest.begin(), rest.end());
  EXPECT_EQ(at_device, to_device);
  EXPECT_EQ(at_host, to_host_bytes);
  const UsbCounters counters = host_.serial.counters();
  EXPECT_EQ(counters.resynchronised, 0u);
  EXPECT_GT(counters.packets_received, 1000u);
}

TEST_P(UsbFunctions, AnEmptyPacketFollowsWholeOnes) {
  ASSERT_TRUE(host_.enumerate());
  ASSERT_NO_FATAL_FAILURE(speak());
  for (const std::size_t size : {1u, 63u, 64u, 65u, 127u, 128u, 129u, 640u, 2048u}) {
    const Bytes sent = numbered(size);
    ASSERT_EQ(host_.serial.write(sent), size);
    host_.serve();
    Bytes got;
    for (;;) {  // as a host reads: up to a short packet
      const auto packet = host_.bulk_in();
      ASSERT_EQ(packet.handshake, Handshake::ack) << size << " bytes, " << got.size() << " come";
      got.insert(got.end(), packet.data.begin(), packet.data.end());
      if (packet.data.size() < 64) break;
    }
    EXPECT_EQ(got, sent);
    EXPECT_EQ(host_.bulk_in().handshake, Handshake::nak);
  }
}

TEST_F(UsbConfigured, TwoPacketsAreAcceptedWithoutTheDevice) {
  for (unsigned i = 0; i < 40; ++i) {
    EXPECT_EQ(host.bulk_out(numbered(64), false), Handshake::ack);
    EXPECT_EQ(host.bulk_out(numbered(64), false), Handshake::ack);
    EXPECT_EQ(host.bulk_out(numbered(64), false), Handshake::nak);
    host.serve();
    EXPECT_EQ(read_all(host).size(), 128u);
  }
}

/// Fills the ring; a packet waits in the first buffer.
void fill(UsbHost& host, Bytes& sent) {
  Bytes line = numbered(63);
  line.push_back('\n');
  for (;;) {
    const Handshake answer = host.bulk_out(line);
    if (answer == Handshake::nak) break;
    ASSERT_EQ(answer, Handshake::ack);
    sent.insert(sent.end(), line.begin(), line.end());
    ASSERT_LE(sent.size(), host.serial.receive_capacity + 128);
  }
}

/// Reads as the main loop does, which makes the interrupt poll again.
Bytes read_on(UsbHost& host) {
  Bytes got;
  for (Bytes piece = read_all(host); !piece.empty(); piece = read_all(host)) {
    got.insert(got.end(), piece.begin(), piece.end());
    host.serial.poll();
    host.serve();
  }
  return got;
}

TEST_F(UsbConfigured, AFullRingMakesTheHostWaitAndLosesNothing) {
  Bytes sent;
  ASSERT_NO_FATAL_FAILURE(fill(host, sent));
  EXPECT_GT(sent.size(), host.serial.receive_capacity);
  for (int i = 0; i < 50; ++i) {
    poll();
    EXPECT_EQ(host.bulk_out(numbered(10)), Handshake::nak);
  }
  EXPECT_EQ(read_on(host), sent);
  ASSERT_EQ(host.bulk_out(numbered(10)), Handshake::ack);
  EXPECT_EQ(read_all(host), numbered(10));
}

TEST(UsbBulk, AStopActsWhileItsPacketWaits) {
  // Fills all but the last buffer, in which the stop arrives.
  for (const std::string text : {"!", "G1X1\n!G1X2\n", "\x84", "G1X1\n\x85"}) {
    UsbHost host;
    ASSERT_TRUE(host.enumerate());
    Bytes sent;
    ASSERT_NO_FATAL_FAILURE(fill(host, sent));
    Bytes first(sent.begin(), sent.begin() + 64);
    ASSERT_FALSE(read_all(host, 64).empty());
    host.serial.poll();
    host.serve();
    ASSERT_NO_FATAL_FAILURE(fill(host, sent = {}));
    std::uint8_t byte = 0;
    EXPECT_FALSE(host.serial.read_realtime(byte));
    // One buffer has become free: the packet in it waits for room in the ring.
    Bytes some(64);
    host.serial.read(some);
    host.serial.poll();
    host.serve();
    ASSERT_EQ(host.bulk_out(Bytes(text.begin(), text.end())), Handshake::ack);
    ASSERT_TRUE(host.serial.read_realtime(byte)) << text;
    EXPECT_NE(text.find(static_cast<char>(byte)), std::string::npos);
    EXPECT_FALSE(host.serial.read_realtime(byte)) << "the byte must be read only once";
    const Bytes rest = read_on(host);
    EXPECT_EQ(std::count_if(rest.begin(), rest.end(), wire::is_realtime), 0);
    EXPECT_FALSE(host.serial.read_realtime(byte));
  }
}

/// Other interrupts occur between the checks of the two buffers.
TEST(UsbBulk, APacketThatArrivesMeanwhileIsScannedBeforeItIsRead) {
  FakeUsb usb;
  rp2040::usb::BulkOut<FakeUsb> out(usb, rp2040::usb::serial_out_place);
  out.start();
  struct Taker {
    FakeUsb& usb;
    std::string events{};
    rp2040::usb::PacketLook inspect(const volatile std::uint32_t*, std::uint32_t size) {
      events += "look" + std::to_string(size) + " ";
      return rp2040::usb::PacketLook::take;
    }
    bool push_packet(const volatile std::uint32_t*, std::uint32_t size) {
      if (size == 5) usb.out(rp2040::usb::data_endpoint, true, numbered(7));
      events += "take" + std::to_string(size) + " ";
      return true;
    }
  } taker{usb};
  ASSERT_EQ(usb.out(rp2040::usb::data_endpoint, false, numbered(5)), Handshake::ack);
  out.service(taker);
  EXPECT_EQ(taker.events, "look5 take5 look7 take7 ");
}

TEST_F(UsbConfigured, AResetDropsEarlierBytes) {
  for (const bool full : {false, true}) {
    Bytes sent;
    if (full) {
      ASSERT_NO_FATAL_FAILURE(fill(host, sent));
      Bytes some(64);
      host.serial.read(some);
      poll();
    } else {
      ASSERT_EQ(host.bulk_out(numbered(20)), Handshake::ack);
    }
    const std::string text = "G1X1\n\x18$I\n";
    ASSERT_EQ(host.bulk_out(Bytes(text.begin(), text.end())), Handshake::ack);
    std::uint8_t byte = 0;
    ASSERT_TRUE(host.serial.read_realtime(byte));
    EXPECT_EQ(byte, 0x18);
    Bytes some(10);
    EXPECT_EQ(host.serial.read(some), 0u);
    poll();
    EXPECT_EQ(read_on(host), (Bytes{'$', 'I', '\n'})) << full;
  }
}

TEST_F(UsbConfigured, NoBufferIsArmedLateInAFrame) {
  for (std::uint32_t offset = 0; offset < 1000; offset += 7) {
    host.frame(offset);
    ASSERT_EQ(host.serial.write(numbered(10)), 10u);
    host.serve();
    const bool late = offset >= 800;
    EXPECT_EQ(host.bulk_in().handshake, late ? Handshake::nak : Handshake::ack) << offset;
    if (!late) continue;
    poll();
    EXPECT_EQ(host.bulk_in().handshake, Handshake::nak);
    host.frame();
    EXPECT_EQ(host.bulk_in().data, numbered(10));
  }
  // Lost starts of frame; no frames at all.
  for (const std::uint32_t since : {999u, 1000u, 1799u, 1800u, 1999u, 2000u, 2799u, 2800u, 2999u,
                                    3000u, 1'000'000u, 0xffffffffu}) {
    EXPECT_EQ(rp2040::late_in_frame(since), since < 3000 && since % 1000 >= 800) << since;
  }
}

TEST(UsbBulk, ANewConnectionStartsEmpty) {
  std::mt19937_64 random(3);
  UsbHost host;
  for (int round = 0; round < scaled(300); ++round) {
    const std::uint32_t generation = host.serial.generation();
    ASSERT_TRUE(host.enumerate());
    EXPECT_NE(host.serial.generation(), generation);
    EXPECT_EQ(host.serial.available(), 0u);
    EXPECT_EQ(host.serial.room(), host.serial.send_capacity);
    EXPECT_EQ(host.bulk_in().handshake, Handshake::nak);
    // Leaves a transfer unfinished.
    for (std::uint64_t i = random() % 5; i > 0; --i) {
      host.bulk_out(numbered(1 + random() % 64), random() % 2 == 0);
      host.serial.write(numbered(random() % 200));
      if (random() % 2 == 0) host.serve();
      if (random() % 2 == 0) host.bulk_in(false);
      Bytes some(random() % 50);
      host.serial.read(some);
    }
    if (random() % 2 == 0) {
      host.usb.suspend();
      host.serve();
      EXPECT_TRUE(host.serial.suspended());
    }
  }
  host.reset();
  EXPECT_FALSE(host.serial.configured());
  EXPECT_EQ(host.serial.write(numbered(5)), 0u);
  EXPECT_EQ(host.serial.room(), 0u);
  EXPECT_EQ(host.bulk_out(numbered(5)), Handshake::silence);
}

TEST_F(UsbConfigured, SuspendComesAndGoes) {
  host.frame();
  EXPECT_FALSE(host.serial.suspended());
  host.usb.suspend();
  host.serve();
  EXPECT_TRUE(host.serial.suspended());
  EXPECT_TRUE(host.serial.configured());
  host.usb.resume();
  host.serve();
  EXPECT_FALSE(host.serial.suspended());
  host.usb.suspend();
  host.serve();
  host.usb.sie_status &= ~rp2040::usb_field::status_suspended;
  host.frame();  // a resume that was not seen
  EXPECT_FALSE(host.serial.suspended());
  EXPECT_EQ(host.serial.counters().suspends, 2u);
  ASSERT_EQ(host.bulk_out(numbered(5)), Handshake::ack);
  EXPECT_EQ(read_all(host), numbered(5));
}

TEST(UsbErrata, OldChipsAreHelpedOutOfAReset) {
  for (const bool old_chip : {true, false}) {
    UsbHost host;
    host.usb.old_chip = old_chip;
    host.usb.sie_status &= ~(3u << 2);  // SE0: the reset continues
    host.reset();
    host.serial.poll();
    EXPECT_FALSE(host.usb.held);
    host.usb.sie_status |= 1u << 2;
    // Held a millisecond after the end of the reset, for a millisecond, once.
    for (const auto& [us, held] :
         {std::pair{1000u, true}, {900u, true}, {100u, false}, {1000u, false}}) {
      host.usb.now_us += us;
      host.serial.poll();
      EXPECT_EQ(host.usb.held, held && old_chip);
    }
    EXPECT_EQ(host.usb.holds, old_chip ? 1 : 0);
  }
}

/// Receives a packet as the interrupt does: first the real-time bytes, then the others.
void receive(rp2040::ReceiveRing<256>& ring, const std::array<std::uint32_t, 16>& words,
             std::size_t size) {
  const auto bytes = static_cast<std::uint32_t>(size);
  ring.take_realtime(words.data(), bytes);
  ASSERT_TRUE(ring.push_packet(words.data(), bytes));
}
void drop_commands(rp2040::ReceiveRing<256>& ring) {
  std::uint8_t command = 0;
  while (ring.pop_realtime(command)) {
  }
}

TEST(UsbRings, ReceiveKeepsEveryByteAtEveryPosition) {
  std::mt19937_64 random(11);
  rp2040::ReceiveRing<256> ring;
  std::deque<std::uint8_t> expected;
  for (int round = 0; round < scaled(20000); ++round) {
    const auto size = static_cast<std::uint32_t>(1 + random() % 64);
    if (expected.size() + size <= 256 - 8) {
      std::array<std::uint32_t, 16> words{};
      // Plain bytes, and some with real-time bytes.
      constexpr std::uint32_t masks[] = {0xffffffff, 0x17171717, 0x0f0f0f0f};
      const std::uint32_t mask = masks[random() % 3];
      for (auto& word : words) word = static_cast<std::uint32_t>(random()) & mask;
      ASSERT_NO_FATAL_FAILURE(receive(ring, words, size));
      drop_commands(ring);
      bool reset = false;
      for (std::uint32_t i = 0; i < size; ++i) {
        const auto byte = static_cast<std::uint8_t>(words[i / 4] >> (8 * (i % 4)));
        if (byte == wire::byte_reset) expected.clear(), reset = true;
        if (!wire::is_realtime(byte)) expected.push_back(byte);
      }
      std::array<std::uint8_t, 1> none{};
      if (reset) {
        ASSERT_EQ(ring.pop(none), 0u);
      }
    } else if (random() % 2 == 0 && expected.size() < 256 - 8) {
      ring.push_byte('b');
      expected.push_back('b');
    }
    ASSERT_EQ(ring.size(), expected.size());
    std::array<std::uint8_t, 80> out{};
    const std::size_t count = ring.pop(std::span(out).first(random() % 80));
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(out[i], expected.front());
      expected.pop_front();
    }
  }
  EXPECT_EQ(ring.losses().bytes, 0u);
}

TEST(UsbRings, WordsWithRealtimeBytesAreKnown) {
  std::mt19937_64 random(4);
  for (int round = 0; round < scaled(100'000); ++round) {
    const std::uint64_t bits = random();
    const auto word = static_cast<std::uint32_t>(bits & (bits >> 32 | 0x3f3f3f3f));
    bool realtime = false;
    for (int shift = 0; shift < 32; shift += 8)
      realtime = realtime || wire::is_realtime(static_cast<std::uint8_t>(word >> shift));
    ASSERT_EQ(rp2040::has_realtime(word), realtime) << word;
  }
  for (unsigned byte = 0; byte < 256; ++byte)
    EXPECT_EQ(rp2040::has_realtime(byte << 16 | 'G'),
              wire::is_realtime(static_cast<std::uint8_t>(byte)))
        << byte;
}

TEST(UsbRings, TheFastSearchMissesNoRealtimeByteAndPassesText) {
  constexpr std::uint32_t neighbours[] = {0, 0xffffffff, 0x17182021, 0x3f7e800a};
  const std::string text = "G1X-12.345Y0 F6000\r\nN7M3S255Z+8\tABCDEHIJKLOPQRTUVW";
  for (unsigned byte = 0; byte < 256; ++byte)
    for (const std::uint32_t others : neighbours)
      for (int shift = 0; shift < 32; shift += 8) {
        const std::uint32_t word = (others & ~(0xffu << shift)) | byte << shift;
        const bool near = (rp2040::near_realtime(word) >> shift & 0x20u) != 0;
        const bool in_text = text.find(static_cast<char>(byte)) != std::string::npos;
        ASSERT_TRUE(near || !wire::is_realtime(static_cast<std::uint8_t>(byte))) << byte;
        ASSERT_FALSE(near && in_text) << byte;
      }
  ASSERT_EQ(rp2040::near_realtime_mask, 0x20202020u);
}

TEST(UsbRings, OverflowMarksTheGapAndDropsNoCommand) {
  rp2040::ReceiveRing<256> ring;
  for (int i = 0; i < 100; ++i)
    for (const char c : std::string("G1X1\n")) ring.push_byte(static_cast<std::uint8_t>(c));
  ring.push_byte('!');
  std::uint8_t byte = 0;
  ASSERT_TRUE(ring.pop_realtime(byte));
  EXPECT_EQ(byte, '!');
  EXPECT_EQ(ring.losses().gaps, 1u);
  EXPECT_EQ(ring.losses().bytes, 500u - ring.size());
  std::array<std::uint8_t, 256> out{};
  EXPECT_EQ(ring.pop(out), 248u);
  ring.push_byte('A');
  EXPECT_EQ(ring.pop(out), 2u);
  EXPECT_EQ(out[0], rp2040::gap_mark);
  EXPECT_EQ(out[1], 'A');
}

/// However it is received and read in pieces, each byte is known to be before or after 0x85.
TEST(UsbRings, TheEndOfJogsLeavesAMark) {
  std::mt19937_64 random(6);
  for (int round = 0; round < scaled(500); ++round) {
    rp2040::ReceiveRing<256> ring;
    std::string text;
    for (auto size = random() % 150; size > 0; --size) text += 'a';
    const std::size_t cancels = random() % 3;
    for (std::size_t i = 0; i < cancels; ++i) text.insert(random() % (text.size() + 1), "\x85");
    const std::size_t last = text.rfind('\x85');
    const std::string before = last == std::string::npos ? "" : text.substr(0, last);
    const auto want = static_cast<std::size_t>(std::count(before.begin(), before.end(), 'a'));
    std::vector<std::string> packets;
    for (std::size_t at = 0; at < text.size();) {
      packets.push_back(text.substr(at, 1 + random() % 64));
      at += packets.back().size();
    }
    // All packets are scanned before any byte is read.
    for (const std::string& packet : packets) {
      std::array<std::uint32_t, 16> words{};
      for (std::size_t i = 0; i < packet.size(); ++i)
        words[i / 4] |= std::uint32_t{static_cast<std::uint8_t>(packet[i])} << (8 * (i % 4));
      ASSERT_NO_FATAL_FAILURE(receive(ring, words, packet.size()));
    }
    drop_commands(ring);
    std::size_t marked = 0, all = 0;
    while (ring.size() != 0) {
      std::array<std::uint8_t, 40> out{};
      const std::size_t count = ring.pop(std::span(out).first(1 + random() % 40));
      all += count;
      if (ring.before_jog_cancel()) marked += count;
    }
    EXPECT_EQ(marked, want) << text;
    EXPECT_EQ(all, text.size() - cancels);
  }
}

TEST(UsbRings, TheMarkSpoilsTheLineAndTheFrame) {
  struct Events {
    int lines = 0, lost = 0, frames = 0, bad = 0;
    void on_realtime(std::uint8_t) {}
    void on_frame(std::span<const std::uint8_t>) { ++frames; }
    void on_bad_frame() { ++bad; }
    void on_line(std::string_view) { ++lines; }
    void on_lost_line() { ++lost; }
  } events;
  wire::StreamParser<wire::End::device> parser;
  for (const char c : std::string("G1X1\x7f"
                                  "5\nG1X2\n"))
    parser.push(static_cast<std::uint8_t>(c), events);
  EXPECT_EQ(events.lost, 1);
  EXPECT_EQ(events.lines, 1);
  std::array<std::uint8_t, wire::max_frame> frame{};
  const Bytes content = numbered(30);
  const std::size_t size = wire::encode_frame(content, frame);
  for (std::size_t i = 0; i < size; ++i) {
    if (i == 10) parser.push(rp2040::gap_mark, events);
    if (i < 10 || i > 13) parser.push(frame[i], events);
  }
  EXPECT_EQ(events.frames, 0);
  EXPECT_EQ(events.bad, 1);
}

}  // namespace
}  // namespace lamplock::test
