// The drives on the board, if its row has any: otherwise an empty class that permits everything.
//
// In:  settings, the UART of the drives. Out: whether they may be enabled; messages. Who: Board.
#pragma once

#include <cstdint>
#include <type_traits>

#include "firmware/machine/board_types.hpp"
#include "shared/boards/this_board.hpp"
#if LAMPLOCK_DRIVE_SETTINGS
#include "firmware/boards/rp2040/drives/drive_setup.hpp"
#include "firmware/boards/rp2040/drives/drive_uart.hpp"
#endif

namespace lamplock::rp2040 {

/// Drives outside of the board.
class NoDrives {
 public:
  static void start() {}
  static void begin(const machine::BoardFeatures&, const settings::Values&, std::uint32_t) {}
  template <class Say>
  static void service(std::uint32_t, bool, Say&&) {}
  static constexpr bool ready() { return true; }
  static constexpr bool failed() { return false; }
  static constexpr bool settled() { return true; }
};

#if LAMPLOCK_DRIVE_SETTINGS
/// Drives that are set up over a UART.
class OwnDrives : private DriveUart, public DriveSetup<DriveUart> {
 public:
  OwnDrives() : DriveUart(row().tx), DriveSetup<DriveUart>(static_cast<DriveUart&>(*this), row()) {}
  void start() {
    DriveUart::start();
    is_started_ = true;
  }
  /// Nothing happens before start(): the wiring is not that of the board.
  [[gnu::cold]] void begin(const machine::BoardFeatures& board, const settings::Values& values,
                           std::uint32_t now_us) {
    if (!is_started_) return;
    const settings::Id unfit = boards::unfit_drive_setting(board.limits, values);
    DriveSetup<DriveUart>::begin(
        values, board.limits.axes,
        unfit == settings::Id::count ? std::uint16_t{0} : settings::number(unfit), now_us);
  }

 private:
  bool is_started_ = false;
  static constexpr const boards::UartDrives& row() { return *boards::this_board.drives; }
};
using Drives = std::conditional_t<boards::this_board.drives.has_value(), OwnDrives, NoDrives>;
#else
static_assert(!boards::this_board.drives, "this core has no settings of drives");
using Drives = NoDrives;
#endif

}  // namespace lamplock::rp2040
