// The way to a real board by the name that --board gives it.
//
// In:  "auto", "usb", "usb:SERIAL", HOST:PORT or a serial port. Out: an open transport.
// Who: every command that talks to a board.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/link/transport.hpp"
#include "host/run/board_options.hpp"

namespace lamplock::run {

/// The board that is plugged in: its pulse stream, or its serial port if that may not be opened or
/// the firmware has none. A line on stderr names the choice.
inline constexpr const char* auto_board = "auto";
/// The pulse stream of the only board; "usb:SERIAL" names one of several.
inline constexpr const char* usb_board = "usb";

/// The serial number that a name of the pulse stream gives, perhaps an empty one; none of other
/// names.
std::optional<std::string> usb_serial(const std::string& board);

/// Opens a board that is not simulated. Throws Error: no_device, or bad_input where the name fits
/// several. `baud`: of a serial port.
std::unique_ptr<link::Transport> open_board(const std::string& board,
                                            unsigned baud = boards::uart_baud);

/// Throws Error(no_device) for a port that does not exist and for a USB board that is not plugged
/// in, without opening it. Simulated boards and HOST:PORT are not checked.
void check_is_connected(const BoardOptions& options);

/// Opens the board of a choice; nothing for simulated boards.
std::unique_ptr<link::Transport> open_port(const BoardOptions& options);

}  // namespace lamplock::run
