#include "tests/flash/board_model.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/flash/uf2.hpp"

namespace lamplock::flash::test {
namespace {

constexpr std::chrono::milliseconds restart_time{300};
constexpr std::uint8_t stream_number = 2;

/// The loader, which restarts its board.
class LoaderDevice final : public usb::Device {
 public:
  LoaderDevice(BusModel& bus, BoardModel& board)
      : bus_(bus), board_(board), model_(board.flash, board.faults) {}

  usb::TransferEnd claim(std::uint8_t number) override { return model_.claim(number); }
  usb::Transfer control(const usb::Setup& setup, std::span<std::uint8_t> data,
                        std::chrono::milliseconds time) override {
    return model_.control(setup, data, time);
  }
  usb::Transfer bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                         std::chrono::milliseconds time) override {
    return model_.bulk_out(endpoint, bytes, time);
  }
  usb::Transfer bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                        std::chrono::milliseconds time) override {
    const usb::Transfer transfer = model_.bulk_in(endpoint, bytes, time);
    if (model_.rebooted()) bus_.restart(board_, false);
    return transfer;
  }
  usb::TransferEnd clear_halt(std::uint8_t endpoint) override {
    return model_.clear_halt(endpoint);
  }
  std::unique_ptr<usb::Stream> stream(std::uint8_t, std::uint8_t) override { return nullptr; }

 private:
  BusModel& bus_;
  BoardModel& board_;
  LoaderModel model_;
};

/// The pulse stream of a running board: only its ownership is modelled.
class StreamDevice final : public usb::Device {
 public:
  explicit StreamDevice(BoardModel& board) : board_(board) {}
  ~StreamDevice() override { board_.stream_held = false; }

  usb::TransferEnd claim(std::uint8_t number) override {
    if (number != stream_number || board_.stream_taken) return usb::TransferEnd::failed;
    board_.stream_held = true;
    return usb::TransferEnd::done;
  }
  usb::Transfer control(const usb::Setup&, std::span<std::uint8_t>,
                        std::chrono::milliseconds) override {
    return {usb::TransferEnd::failed, 0};
  }
  usb::Transfer bulk_out(std::uint8_t, std::span<const std::uint8_t>,
                         std::chrono::milliseconds) override {
    return {usb::TransferEnd::failed, 0};
  }
  usb::Transfer bulk_in(std::uint8_t, std::span<std::uint8_t>, std::chrono::milliseconds) override {
    return {usb::TransferEnd::failed, 0};
  }
  usb::TransferEnd clear_halt(std::uint8_t) override { return usb::TransferEnd::failed; }
  std::unique_ptr<usb::Stream> stream(std::uint8_t, std::uint8_t) override { return nullptr; }

 private:
  BoardModel& board_;
};

/// The firmware's answers.
class BoardTransport final : public link::Transport {
 public:
  BoardTransport(BusModel& bus, BoardModel& board) : bus_(bus), board_(board) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      if (byte == '?') {
        board_.heard.emplace_back("?");
        if (!board_.status.empty() && bus_.now() >= board_.heard_from)
          reply("<" + board_.status + "|MPos:0.000,0.000,0.000>");
      } else if (byte != '\n') {
        line_ += static_cast<char>(byte);
      } else {
        take(std::exchange(line_, ""));
      }
    }
    return bytes.size();
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    const std::size_t size = std::min(bytes.size(), answer_.size());
    std::copy_n(answer_.begin(), size, bytes.begin());
    answer_.erase(0, size);
    return size;
  }
  void wait(std::chrono::microseconds time) override {
    bus_.sleep(std::chrono::ceil<std::chrono::milliseconds>(time));
  }
  std::chrono::microseconds now() const override { return bus_.now(); }
  bool connected() const override {
    return board_.runs() && bus_.now() >= board_.back_at && bus_.now() < board_.port_goes_at;
  }
  bool reconnect() override { return false; }

 private:
  void reply(const std::string& line) { answer_ += line + "\r\n"; }
  void take(const std::string& line) {
    board_.heard.push_back(line);
    if (line == "$I" && board_.tells_version) {
      // The version of an image is the last byte of its boot code.
      reply("[VER:1." + std::to_string(board_.flash.bytes[251]) + ":]");
      reply("ok");
    }
    if (line != "$BOOT") return;
    if (board_.boot_error != 0) return reply("error:" + std::to_string(board_.boot_error));
    reply("ok");
    board_.sent_with_stream = board_.stream_held;
    bus_.restart(board_, true);
  }

  BusModel& bus_;
  BoardModel& board_;
  std::string line_, answer_;
};

}  // namespace

BoardModel& BusModel::at(const std::string& place) {
  return *std::find_if(boards.begin(), boards.end(),
                       [&](const BoardModel& board) { return board.place == place; });
}

void BusModel::restart(BoardModel& board, bool into_loader) {
  board.in_loader = into_loader;
  board.back_at = now_ + restart_time;
}

namespace {

/// The blocks of a file, if it is complete.
std::optional<std::vector<Part>> whole_uf2(const std::filesystem::path& file) {
  try {
    return read_uf2(read_file(file), "copy");
  } catch (const Uf2Error&) {
    return std::nullopt;
  }
}

/// The ROM accepts a file copied to the drive and restarts, so the drive disappears. It waits for
/// the rest of an incomplete one.
bool take_copy(BoardModel& board) {
  const std::filesystem::path file = board.drive / "LAMPLOCK.UF2";
  if (board.drive.empty() || !std::filesystem::exists(file)) return false;
  const auto parts = whole_uf2(file);
  if (!parts) return false;
  for (const Part& part : *parts)
    std::copy(part.bytes.begin(), part.bytes.end(),
              board.flash.bytes.begin() + (part.address - flash_base));
  std::filesystem::remove_all(board.drive);
  return true;
}

}  // namespace

void BusModel::sleep(std::chrono::milliseconds time) {
  now_ += time;
  for (BoardModel& board : boards)
    if (take_copy(board)) restart(board, false);
}

std::vector<usb::DeviceInfo> BusModel::devices() {
  std::vector<usb::DeviceInfo> found;
  for (const BoardModel& board : boards) {
    if (now_ < board.back_at) continue;
    usb::DeviceInfo info = LoaderModel::info(true);
    info.place = board.place;
    info.problem = board.loader_problem;
    if (board.runs()) {
      info = {};
      info.vendor = 0x1209;
      info.product = 0x0001;
      info.manufacturer = "lamplock";
      info.name = board.name;
      info.serial = board.serial;
      info.place = board.place;
      info.problem = board.problem;
      const auto bulk = usb::Endpoint::Kind::bulk;
      info.interfaces = {{stream_number, 0xff, 0, 0, {{0x03, bulk, 64}, {0x83, bulk, 64}}}};
    }
    found.push_back(info);
  }
  return found;
}

std::unique_ptr<usb::Device> BusModel::open(const usb::DeviceInfo& device) {
  BoardModel& board = at(device.place);
  if (board.runs()) return std::make_unique<StreamDevice>(board);
  return std::make_unique<LoaderDevice>(*this, board);
}

std::unique_ptr<link::Transport> PortsModel::open(const usb::DeviceInfo& board) {
  BoardModel& model = bus_.at(board.place);
  if (!model.runs())
    throw Error(Exit::no_device, "/dev/port" + board.place, "is not there", "plug it in");
  return std::make_unique<BoardTransport>(bus_, model);
}

}  // namespace lamplock::flash::test
