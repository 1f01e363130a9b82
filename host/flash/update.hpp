// Updates the firmware of a board: from the running board, or its boot loader, to the board that
// runs the new firmware.
//
// In:  a bus, ports, an image; the board. Out: a report of the flash and of the running version, or
//      an Error that says in which state the board is.
// Who: `lamplock flash`.
//
// A board with a job is left alone, and so is one whose pulse stream another program uses: during a
// job over the stream the board does not answer at its serial port. A board that is silent for
// longer than such a job lasts without its host, or not on the bus, may be reset into its loader by
// lines of the computer, if no other board can be meant. (A job over UART0 is not detected.)
// Without permission to use the loader over USB the image is copied to its drive, if mounted.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "host/flash/board_ports.hpp"
#include "host/flash/drive.hpp"
#include "host/flash/flash_image.hpp"
#include "host/flash/flasher.hpp"
#include "host/usb/known_devices.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::flash {

/// Result of an update.
struct UpdateReport {
  usb::DeviceInfo board{};             ///< as it runs now; without place if it was not found
  std::string version_before{};        ///< empty: it was in its boot loader
  std::string version{};               ///< empty: see version_problem
  std::string version_problem{};       ///< why the new version was not read; one line
  std::string port{};                  ///< of the board
  std::optional<FlashResult> flash{};  ///< over USB
  std::optional<std::filesystem::path> drive{};  ///< or by a copy

  /// The new firmware has reported its version; or the board of a given drive was not found.
  bool confirmed() const { return version_problem.empty() || board.place.empty(); }
};

/// Callbacks: a completed step with its result; progress of the flash.
struct UpdateEvents {
  std::function<void(const std::string& step, const std::string& what)> on_step{};
  OnFlashProgress on_progress{};
};

/// Bus, ports and drives. All must outlive the update.
struct UpdateSite {
  usb::Bus& bus;
  BoardPorts& ports;
  std::vector<std::filesystem::path> drive_roots{};  ///< where drives are mounted
  WriteFile write_file = write_through;              ///< to one of them
  /// Resets the board into its loader by its pins, which ends any job; empty: not wired. Throws
  /// Error.
  std::function<void()> pull_loader_lines{};
};

/// One update.
class Update {
 public:
  Update(UpdateSite site, const FlashImage& image, UpdateEvents events);

  /// Updates the board with this serial number, or the only one. Throws Error; also if it runs the
  /// image of another board than `for_board` (BoardRow::name; empty: the image is for any).
  UpdateReport run(const std::string& serial, const std::string& for_board = {});
  /// Updates the board of a mounted drive. Throws Error.
  UpdateReport run_on_drive(const std::filesystem::path& drive);

 private:
  usb::DeviceInfo find(const std::string& serial);
  static void refuse_other_board(const usb::DeviceInfo& target, const std::string& for_board);
  void stop_board(const usb::DeviceInfo& board);
  void pull_loader_lines(const std::string& why) const;
  void check_way(const usb::DeviceInfo& board);
  std::unique_ptr<usb::Device> take_stream(const usb::DeviceInfo& board);
  void check_other_loaders(const usb::DeviceInfo& device);
  std::string also_to_know(const std::string& remedy) const;
  usb::DeviceInfo wait_for_loader(const std::string& place);
  void flash_over_usb(const usb::DeviceInfo& loader);
  void flash_over_drive(const std::filesystem::path& drive);
  std::filesystem::path wait_for_drive(const usb::DeviceInfo& loader);
  void wait_for_board(const std::string& place);
  void refuse_broken_copy(const std::string& where) const;
  void ask_version();
  std::set<std::string> boards();
  std::optional<usb::DeviceInfo> new_board();
  void step(const std::string& name, const std::string& what) const;

  std::error_code copy_doubt_{};  ///< error of the copy to a drive, perhaps due to the restart
  UpdateSite site_;
  const FlashImage& image_;
  UpdateEvents events_;
  UpdateReport report_;
  std::set<std::string> boards_before_;  ///< places
};

}  // namespace lamplock::flash
