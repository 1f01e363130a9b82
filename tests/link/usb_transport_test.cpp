// The transport of the pulse stream: the choice of the board, and how a job survives a cut cable.
#include "host/link/usb_transport.hpp"

#include <gmock/gmock.h>

#include <deque>
#include <map>
#include <random>

#include "host/error.hpp"
#include "host/job/job.hpp"
#include "host/link/sender.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/drive_settings.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

using link::UsbTransport;
using sim::ps_per_ms;
using sim::ps_per_us;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::HasSubstr;

/// State of a plugged-in board besides its descriptors.
struct Plugged {
  usb::DeviceInfo info;
  sim::Board* board = nullptr;  ///< moves bytes and time; null: a silent board
  std::deque<std::uint8_t> leftovers{};
  bool busy = false;       ///< another program has its interface
  std::uint64_t plug = 0;  ///< differs each time it is plugged in
};

usb::DeviceInfo board_info(const std::string& serial, const std::string& place) {
  usb::DeviceInfo info;
  info.vendor = 0x1209;
  info.product = 0x0001;
  info.place = place;
  info.manufacturer = "lamplock";
  info.name = "lamplock pico";
  info.serial = serial;
  using Kind = usb::Endpoint::Kind;
  info.interfaces = {{0, 2, 2, 0, {{0x81, Kind::interrupt, 16}}},
                     {1, 10, 0, 0, {{0x02, Kind::bulk, 64}, {0x82, Kind::bulk, 64}}},
                     {2, 0xff, 0, 0, {{0x03, Kind::bulk, 64}, {0x83, Kind::bulk, 64}}}};
  return info;
}

/// A bus on which devices are plugged in and out.
class FakeBus final : public usb::Bus {
 public:
  std::vector<usb::DeviceInfo> devices() override {
    std::vector<usb::DeviceInfo> all;
    all.reserve(plugged.size());
    for (const auto& [place, device] : plugged) all.push_back(device.info);
    return all;
  }
  std::unique_ptr<usb::Device> open(const usb::DeviceInfo& info) override;
  void sleep(milliseconds time) override { pass(time); }
  milliseconds now() override { return std::chrono::duration_cast<milliseconds>(time_); }

  void plug(usb::DeviceInfo info, sim::Board* board = nullptr) {
    const std::string place = info.place;
    plugged[place] = {std::move(info), board, {}, false, ++plugs_};
  }
  void unplug(const std::string& place) {
    if (plugged.at(place).board != nullptr) plugged.at(place).board->reconnect();
    plugged.erase(place);
  }
  Plugged* find(const std::string& place, std::uint64_t plug) {
    const auto found = plugged.find(place);
    return found == plugged.end() || found->second.plug != plug ? nullptr : &found->second;
  }
  /// Advances every board that has a clock, unplugged ones included.
  void pass(microseconds time) {
    time_ += time;
    for (sim::Board* board : clocks) board->run_until(time_.count() * ps_per_us);
  }

  std::map<std::string, Plugged> plugged;  ///< by place
  std::vector<sim::Board*> clocks;
  int opened = 0;

 private:
  microseconds time_{0};
  std::uint64_t plugs_ = 0;
};

class FakeStream final : public usb::Stream {
 public:
  FakeStream(FakeBus& bus, std::string place, std::uint64_t plug)
      : bus_(bus), place_(std::move(place)), plug_(plug) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    Plugged* const device = bus_.find(place_, plug_);
    if (device == nullptr) return 0;
    return device->board != nullptr ? device->board->write(bytes) : bytes.size();
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    Plugged* const device = bus_.find(place_, plug_);
    if (device == nullptr) return 0;
    std::size_t count = 0;
    for (; count < bytes.size() && !device->leftovers.empty(); ++count) {
      bytes[count] = device->leftovers.front();
      device->leftovers.pop_front();
    }
    if (device->board != nullptr) count += device->board->read(bytes.subspan(count));
    return count;
  }
  void wait(microseconds time) override {
    const Plugged* const device = bus_.find(place_, plug_);
    for (microseconds passed{0}; passed < time && alive(); passed += slice) {
      if (device != nullptr && device->board != nullptr && device->board->has_output()) return;
      bus_.pass(slice);
    }
  }
  bool alive() const override { return bus_.find(place_, plug_) != nullptr; }

 private:
  static constexpr microseconds slice{1000};
  FakeBus& bus_;
  std::string place_;
  std::uint64_t plug_;
};

class FakeDevice final : public usb::Device {
 public:
  FakeDevice(FakeBus& bus, const Plugged& device)
      : bus_(bus), place_(device.info.place), plug_(device.plug) {}

  usb::TransferEnd claim(std::uint8_t interface_number) override {
    EXPECT_EQ(interface_number, 2);
    const Plugged* const device = bus_.find(place_, plug_);
    if (device == nullptr) return usb::TransferEnd::gone;
    return device->busy ? usb::TransferEnd::failed : usb::TransferEnd::done;
  }
  usb::Transfer control(const usb::Setup&, std::span<std::uint8_t>, milliseconds) override {
    return {usb::TransferEnd::stalled, 0};
  }
  usb::Transfer bulk_out(std::uint8_t, std::span<const std::uint8_t>, milliseconds) override {
    return {usb::TransferEnd::stalled, 0};
  }
  usb::Transfer bulk_in(std::uint8_t, std::span<std::uint8_t>, milliseconds) override {
    return {usb::TransferEnd::stalled, 0};
  }
  usb::TransferEnd clear_halt(std::uint8_t) override { return usb::TransferEnd::done; }
  std::unique_ptr<usb::Stream> stream(std::uint8_t out, std::uint8_t in) override {
    EXPECT_EQ(out, 0x03);
    EXPECT_EQ(in, 0x83);
    return std::make_unique<FakeStream>(bus_, place_, plug_);
  }

 private:
  FakeBus& bus_;
  std::string place_;
  std::uint64_t plug_;
};

std::unique_ptr<usb::Device> FakeBus::open(const usb::DeviceInfo& info) {
  const auto found = plugged.find(info.place);
  if (found == plugged.end())
    throw Error(Exit::no_device, info.place, "is not there any more", "plug it in again");
  if (!info.problem.empty()) throw Error(Exit::no_device, info.place, info.problem, "grant access");
  ++opened;
  return std::make_unique<FakeDevice>(*this, found->second);
}

template <class Call>
Error error_from(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error";
  return Error(Exit::done, "", "", "");
}

TEST(UsbTransport, TakesTheOnlyBoardOrTheNamedOne) {
  const auto bus = std::make_shared<FakeBus>();
  usb::DeviceInfo mouse;
  mouse.place = "1-1";
  bus->plug(mouse);
  usb::DeviceInfo namesake = board_info("XYZ", "1-2");  // these USB IDs are free for private tests
  namesake.manufacturer = "another maker";
  bus->plug(namesake);
  const Error none = error_from([&] { link::find_board(*bus, ""); });
  EXPECT_EQ(none.exit(), Exit::no_device);
  EXPECT_THAT(none.what(), HasSubstr("no board"));
  bus->plug(board_info("AAA", "1-3"));
  EXPECT_EQ(link::find_board(*bus, "").place, "1-3");
  bus->plug(board_info("BBB", "1-4.1"));
  EXPECT_EQ(link::find_board(*bus, "BBB").place, "1-4.1");
  const Error several = error_from([&] { link::find_board(*bus, ""); });
  EXPECT_EQ(several.exit(), Exit::bad_input);
  EXPECT_THAT(several.what(), HasSubstr("AAA, BBB"));
  const Error wrong = error_from([&] { link::find_board(*bus, "CCC"); });
  EXPECT_EQ(wrong.exit(), Exit::no_device);
  EXPECT_THAT(wrong.what(), HasSubstr("AAA, BBB"));
  UsbTransport transport(bus, link::find_board(*bus, "BBB"));
  EXPECT_TRUE(transport.connected());
}

TEST(UsbTransport, ReportsWhyABoardCannotBeUsed) {
  const auto bus = std::make_shared<FakeBus>();
  usb::DeviceInfo old = board_info("OLD", "1-1");
  old.interfaces.pop_back();
  bus->plug(old);
  EXPECT_THAT(error_from([&] { UsbTransport(bus, link::find_board(*bus, "")); }).what(),
              HasSubstr("no pulse stream interface"));
  EXPECT_EQ(bus->opened, 0);
  bus->plug(board_info("NEW", "1-1"));
  bus->plugged.at("1-1").busy = true;
  const Error busy = error_from([&] { UsbTransport(bus, link::find_board(*bus, "")); });
  EXPECT_EQ(busy.exit(), Exit::no_device);
  EXPECT_THAT(busy.what(), HasSubstr("another program"));
  bus->plugged.at("1-1").busy = false;
  bus->plugged.at("1-1").info.problem = "may not be opened";
  EXPECT_THAT(error_from([&] { UsbTransport(bus, link::find_board(*bus, "")); }).what(),
              HasSubstr("may not be opened"));
}

TEST(UsbTransport, OldBytesAreDiscardedWhenItOpens) {
  const auto bus = std::make_shared<FakeBus>();
  bus->plug(board_info("AAA", "1-1"));
  for (const char c : std::string(3000, 'x') + "ok\r\n")
    bus->plugged.at("1-1").leftovers.push_back(static_cast<std::uint8_t>(c));
  UsbTransport transport(bus, link::find_board(*bus, ""));
  std::array<std::uint8_t, 64> bytes{};
  EXPECT_EQ(transport.read(bytes), 0u);
  bus->plugged.at("1-1").leftovers.assign({'o', 'k'});
  EXPECT_EQ(transport.read(bytes), 2u);
}

TEST(UsbTransport, FindsItsBoardAgainAtAnotherPlaceAndNoOther) {
  const auto bus = std::make_shared<FakeBus>();
  bus->plug(board_info("AAA", "1-1"));
  UsbTransport transport(bus, link::find_board(*bus, ""));
  const std::array<std::uint8_t, 1> byte{'?'};
  EXPECT_EQ(transport.write(byte), 1u);
  bus->unplug("1-1");
  EXPECT_FALSE(transport.connected());
  EXPECT_EQ(transport.write(byte), 0u);
  EXPECT_FALSE(transport.reconnect());
  // Time advances while the board is unplugged; otherwise a sender would wait forever.
  const microseconds before = transport.now();
  transport.wait(microseconds(1500));
  EXPECT_GE(transport.now() - before, microseconds(1500));
  bus->plug(board_info("BBB", "1-1"));
  EXPECT_FALSE(transport.reconnect());
  bus->plug(board_info("AAA", "2-3"));
  bus->plugged.at("2-3").busy = true;
  EXPECT_FALSE(transport.reconnect());
  bus->plugged.at("2-3").busy = false;
  EXPECT_TRUE(transport.reconnect());
  EXPECT_TRUE(transport.connected());
  EXPECT_EQ(transport.write(byte), 1u);
  // A board that has restarted at the same place is a new connection, too.
  bus->unplug("2-3");
  bus->plug(board_info("AAA", "2-3"));
  EXPECT_FALSE(transport.connected());
  EXPECT_TRUE(transport.reconnect());
}

TEST(UsbTransport, AJobContinuesWhereverItsBoardIsPluggedInAgain) {
  job::Profile profile = job::default_profile();
  job::set_lamp_hz(profile, 500);
  std::mt19937_64 random(18);
  std::uniform_real_distribution<> step(-0.05, 0.05);
  geometry::PointCloud cloud{{0, 0, 0}};
  while (cloud.size() < 200) {
    const geometry::Point& p = cloud.back();
    cloud.push_back({p.x + step(random), p.y + step(random), p.z + step(random)});
  }
  const job::Job job = job::make_job(cloud, profile, {});
  int cuts = 0;
  for (int round = 0; round < scaled(10); ++round) {
    sim::WorldConfig world;
    world.lamp.frequency_hz = 500;
    world.drives = sim::drives_of(profile.settings);
    sim::VirtualBoard board(profile.settings, world);
    const auto bus = std::make_shared<FakeBus>();
    bus->clocks.push_back(&board);
    bus->plug(board_info("AAA", "1-1"), &board);
    bus->plug(board_info("BBB", "1-2"));
    UsbTransport transport(bus, link::find_board(*bus, "AAA"));
    link::SenderOptions options;
    options.session = 1;
    options.reply_timeout = milliseconds(30);
    options.status_interval = milliseconds(20);
    link::JobSender sender(transport, job, options);
    std::string place = "1-1";
    milliseconds next{static_cast<std::int64_t>(50 + random() % 100)};
    for (bool more = true; more; more = sender.step()) {
      if (bus->now() < next) continue;
      if (!place.empty()) {
        bus->unplug(place);
        place.clear();
        ++cuts;
        next = bus->now() + milliseconds(random() % 50);
      } else {
        place = "2-" + std::to_string(1 + random() % 4);
        bus->plug(board_info("AAA", place), &board);
        next = bus->now() + milliseconds(300 + random() % 200);
      }
    }
    EXPECT_EQ(sender.result().end, link::JobEnd::done);
    EXPECT_GT(sender.result().reconnects, 0u);
    const sim::Shots& shots = board.world().laser().shots();
    ASSERT_EQ(shots.size(), job.targets.size()) << "each point once";
    for (std::size_t i = 0; i < shots.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(shots[i].steps[axis], job.targets[i].steps[axis], 1) << i;
  }
  EXPECT_GT(cuts, scaled(10));
}

}  // namespace
}  // namespace lamplock::test
