#include "host/flash/update.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/error.hpp"
#include "host/flash/board_dialog.hpp"
#include "host/flash/target.hpp"
#include "host/flash/uf2.hpp"
#include "host/link/usb_transport.hpp"

namespace lamplock::flash {
namespace {

using std::chrono::milliseconds;
using usb::DeviceInfo;
using usb::Kind;

/// From `$BOOT` or the restart to the device's enumeration at a slow hub.
constexpr milliseconds enumeration_time{15'000};
/// For the system after that: permissions by rules, the driver of the port, mounting.
constexpr milliseconds settling_time{5'000};
constexpr milliseconds poll_interval{50};
/// The board answers the command before it restarts.
constexpr milliseconds restart_delay{100};

constexpr const char* take_in_hand =
    "plug it in again; if it does not start, hold BOOTSEL while plugging in and flash again";

/// Calls `find` until it returns a result; gives up after `time`.
template <class Find>
auto poll(usb::Bus& bus, milliseconds time, Find&& find) -> decltype(find()) {
  const milliseconds end = bus.now() + time;
  for (;;) {
    if (auto found = find()) return found;
    if (bus.now() >= end) return {};
    bus.sleep(poll_interval);
  }
}

}  // namespace

Update::Update(UpdateSite site, const FlashImage& image, UpdateEvents events)
    : site_(std::move(site)), image_(image), events_(std::move(events)) {}

void Update::step(const std::string& name, const std::string& what) const {
  if (events_.on_step) events_.on_step(name, what);
}

UpdateReport Update::run(const std::string& serial, const std::string& for_board) {
  const DeviceInfo target = find(serial);
  refuse_other_board(target, for_board);
  boards_before_ = boards();
  boards_before_.erase(target.place);
  DeviceInfo loader = target;
  if (usb::known_device(target).kind == Kind::board) {
    stop_board(target);
    loader = wait_for_loader(target.place);
  }
  step("found", name_of(loader));
  if (loader.problem.empty())
    flash_over_usb(loader);
  else
    flash_over_drive(wait_for_drive(loader));
  wait_for_board(target.place);
  ask_version();
  return report_;
}

UpdateReport Update::run_on_drive(const std::filesystem::path& drive) {
  boards_before_ = boards();
  flash_over_drive(drive);
  if (const auto board = poll(site_.bus, settling_time, [&] { return new_board(); })) {
    report_.board = *board;
    ask_version();
  } else {
    refuse_broken_copy(drive.string());
    report_.version_problem = "the drive has disappeared, and no new board is on the bus";
  }
  return report_;
}

// --- from the running board to its loader ---

/// The device to be flashed. A board that does not appear on the bus is reset by lines, unless a
/// serial number is given: all loaders have the same one (docs/devices.md).
DeviceInfo Update::find(const std::string& serial) {
  if (!site_.pull_loader_lines || !serial.empty() || !flashable(site_.bus).empty())
    return find_target(site_.bus, serial);
  pull_loader_lines("no board is plugged in");
  const auto loader = poll(site_.bus, enumeration_time, [&]() -> std::optional<DeviceInfo> {
    const auto there = flashable(site_.bus);
    return there.empty() ? std::nullopt : std::make_optional(there.front());
  });
  return loader ? wait_for_loader(loader->place) : find_target(site_.bus, serial);
}

/// An image of another board may short outputs of this one. What was flashed by mistake can be
/// replaced from the loader, which does not know its board.
void Update::refuse_other_board(const DeviceInfo& target, const std::string& for_board) {
  const boards::BoardRow* runs = usb::board_of(target);
  if (runs == nullptr || for_board.empty() || runs->name == for_board) return;
  throw Error(Exit::bad_input, name_of(target),
              fmt::format("runs the image of a board {}, not of {}", runs->name, for_board),
              fmt::format("flash --for {}; if it is a {}, hold BOOTSEL while plugging it in, then "
                          "flash again",
                          runs->name, for_board));
}

void Update::stop_board(const DeviceInfo& board) {
  const std::string name = name_of(board);
  check_way(board);
  // The stream is kept, so that no job can begin meanwhile.
  const std::unique_ptr<usb::Device> stream = take_stream(board);
  const auto transport = site_.ports.open(board);
  // Without permission for its stream a silent board may run a job over it. And with several boards
  // the lines may belong to another one.
  const bool may_pull =
      site_.pull_loader_lines && board.problem.empty() && flashable(site_.bus).size() == 1;
  try {
    report_.version_before =
        version_at_rest(*transport, name, may_pull ? Asked::to_be_sure : Asked::briefly);
    step("board", fmt::format("{}, version {}", name, report_.version_before));
    enter_boot_loader(*transport, name);
  } catch (const Error& error) {
    // A board that runs a job or refuses has said so; one whose port has disappeared may run a job.
    if (!may_pull || error.exit() != Exit::no_device || !transport->connected()) throw;
    pull_loader_lines(name + " does not answer");
  }
}

void Update::pull_loader_lines(const std::string& why) const {
  site_.pull_loader_lines();
  step("lines", why + ": the board was reset into its boot loader");
}

/// Without permission for the board there is none for its loader either; the drive is needed.
void Update::check_way(const DeviceInfo& board) {
  if (board.problem.empty()) return;
  check_other_loaders(board);
  const auto& roots = site_.drive_roots;
  std::error_code unread;
  if (std::none_of(roots.begin(), roots.end(), [&](const std::filesystem::path& root) {
        return std::filesystem::is_directory(root, unread);
      }))
    throw Error(Exit::no_device, name_of(board), board.problem,
                "nothing was sent to the board: it runs as before");
}

/// Throws Error(job_failed) if another program uses the stream. Null without permission for USB.
std::unique_ptr<usb::Device> Update::take_stream(const DeviceInfo& board) {
  const auto stream = link::stream_interface(board);
  if (!board.problem.empty() || !stream) return nullptr;
  std::unique_ptr<usb::Device> device = site_.bus.open(board);
  const usb::TransferEnd end = device->claim(stream->number);
  if (end == usb::TransferEnd::gone)
    throw Error(Exit::no_device, name_of(board), "was unplugged", "plug it in again, then flash");
  if (end != usb::TransferEnd::done)
    throw Error(Exit::job_failed, name_of(board),
                "another program uses it over its pulse stream (a job may run)",
                "end that program, then flash");
  return device;
}

DeviceInfo Update::wait_for_loader(const std::string& place) {
  const auto find = [&] { return find_at(site_.bus, Kind::boot_loader, place); };
  const auto loader = poll(site_.bus, enumeration_time, find);
  if (!loader)
    throw Error(
        Exit::no_device, "boot loader",
        fmt::format("did not start at USB {} within {} s", place, enumeration_time.count() / 1'000),
        take_in_hand);
  if (loader->problem.empty()) return *loader;
  // The system's rules may grant the permission in a moment.
  const auto permitted = poll(site_.bus, settling_time, [&] {
    auto now = find();
    return now && now->problem.empty() ? now : std::nullopt;
  });
  return permitted.value_or(*loader);
}

// --- the image ---

void Update::flash_over_usb(const DeviceInfo& info) {
  const std::unique_ptr<usb::Device> device = site_.bus.open(info);
  Picoboot loader(*device, info);
  const FlashResult result = Flasher(loader, image_, events_.on_progress).run();
  report_.flash = result;
  step("flash", fmt::format("{} sectors of 4 KiB, {} of them differed: written and read back",
                            result.sectors, result.written));
  loader.reboot(restart_delay);
}

void Update::check_other_loaders(const DeviceInfo& device) {
  for (const DeviceInfo& other : site_.bus.devices())
    if (other.place != device.place && usb::known_device(other).kind == Kind::boot_loader)
      throw Error(Exit::bad_input, name_of(device),
                  "its drive cannot be distinguished from that of " + name_of(other),
                  also_to_know("unplug the other one, or choose the drive with --drive"));
}

/// A remedy, with the state of a board that ran its firmware before.
std::string Update::also_to_know(const std::string& remedy) const {
  if (report_.version_before.empty()) return remedy;
  return remedy +
         " (the board waits in its boot loader; plugged in again it runs its old firmware)";
}

std::filesystem::path Update::wait_for_drive(const DeviceInfo& loader) {
  check_other_loaders(loader);
  const auto drives = poll(site_.bus, settling_time, [&] {
    auto found = find_loader_drives(site_.drive_roots);
    return found.empty() ? std::nullopt : std::make_optional(std::move(found));
  });
  if (!drives)
    throw Error(Exit::no_device, name_of(loader), loader.problem,
                also_to_know("or mount its drive RPI-RP2 and give that with --drive"));
  if (drives->size() > 1)
    throw Error(Exit::bad_input, name_of(loader),
                fmt::format("{} drives of boot loaders are mounted", drives->size()),
                also_to_know("choose one with --drive"));
  return drives->front();
}

void Update::flash_over_drive(const std::filesystem::path& drive) {
  DriveActions actions;
  actions.write = site_.write_file;
  actions.sleep = [&](milliseconds time) { site_.bus.sleep(time); };
  actions.now = [&] { return site_.bus.now(); };
  actions.board_is_back = [&] { return new_board().has_value(); };
  copy_doubt_ = copy_to_drive(drive, write_uf2(image_), actions);
  report_.drive = drive;
  step("copy", fmt::format("{} bytes to {}{}", image_.size, drive.string(),
                           copy_doubt_ ? "" : ", accepted by the board"));
}

// --- the board with the new firmware ---

std::set<std::string> Update::boards() {
  std::set<std::string> places;
  for (const DeviceInfo& device : site_.bus.devices())
    if (usb::known_device(device).kind == Kind::board) places.insert(device.place);
  return places;
}

std::optional<DeviceInfo> Update::new_board() {
  for (const DeviceInfo& device : site_.bus.devices())
    if (usb::known_device(device).kind == Kind::board && !boards_before_.contains(device.place))
      return device;
  return std::nullopt;
}

void Update::wait_for_board(const std::string& place) {
  bool left = false, came_back_as_loader = false;
  const auto board = poll(site_.bus, enumeration_time, [&]() -> std::optional<DeviceInfo> {
    const bool loader = find_at(site_.bus, Kind::boot_loader, place).has_value();
    left = left || !loader;
    came_back_as_loader = came_back_as_loader || (left && loader);
    return came_back_as_loader ? DeviceInfo{} : find_at(site_.bus, Kind::board, place);
  });
  if (!board || came_back_as_loader) refuse_broken_copy("board");
  if (came_back_as_loader)
    throw Error(Exit::job_failed, "board", "has the image but does not start it",
                "check that the image is for this board, then flash again");
  if (!board)
    throw Error(Exit::job_failed, "board",
                fmt::format("has the image but did not start lamplock at USB {}", place),
                take_in_hand);
  report_.board = *board;
}

/// The board does not run, and its copy may be incomplete.
void Update::refuse_broken_copy(const std::string& where) const {
  if (!copy_doubt_) return;
  throw Error(Exit::job_failed, where,
              fmt::format("the copy broke off or the board restarted during the last write ({}), "
                          "and lamplock did not start",
                          copy_doubt_.message()),
              take_in_hand);
}

/// The system makes the port, and permits its use, some time after the device has appeared.
void Update::ask_version() {
  const auto version_now = poll(site_.bus, settling_time, [&]() -> std::optional<std::string> {
    try {
      const auto transport = site_.ports.open(report_.board);
      return version(*transport);
    } catch (const Error& error) {
      report_.version_problem = error.message();
      return std::nullopt;
    }
  });
  report_.port = site_.ports.name(report_.board);
  if (!version_now) return;
  report_.version = *version_now;
  report_.version_problem.clear();
  step("board",
       fmt::format("{} at {}, version {}", name_of(report_.board), report_.port, report_.version));
}

}  // namespace lamplock::flash
