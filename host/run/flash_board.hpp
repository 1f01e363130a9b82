// Writes the firmware to a board over USB, or to a simulated chip.
//
// In:  an image, which board. Out: a report. Who: `flash`.
#pragma once

#include <string>

#include "host/flash/update.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

struct FlashOptions {
  std::string image, serial, drive, lines;
  std::string for_board;      ///< name of the board whose image is flashed if none is given
  std::string board = "usb";  ///< or "chip", a simulated one with an empty flash
};

struct Flashed {
  std::string file;   ///< the image
  std::string board;  ///< board of the image; empty: unknown
  flash::UpdateReport report;
};

/// Throws Error.
Flashed flash_board(const FlashOptions& options, Frontend& frontend);

}  // namespace lamplock::run
