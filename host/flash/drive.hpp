// The drive RPI-RP2 that the boot loader shows: flashing without access to USB, by a copy.
//
// In:  folders; the bytes of a UF2 file. Out: a copy, and whether the board has taken it.
// Who: Update, when the loader may not be used directly; `flash --drive`.
//
// The drive vanishes in the middle of the last write when the board restarts: an error of the
// system then is no error. RP2040 datasheet, 2.8.4.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string_view>
#include <system_error>
#include <vector>

namespace lamplock::flash {

/// Where desktops put drives: under these, or one folder below for each user.
std::vector<std::filesystem::path> usual_drive_roots();

/// True for the folder of an RP2040's boot loader: its INFO_UF2.TXT says so.
bool is_loader_drive(const std::filesystem::path& folder);

/// Those that are mounted, by path.
std::vector<std::filesystem::path> find_loader_drives(
    const std::vector<std::filesystem::path>& roots);

/// Writes a file through to the device; what went wrong, if anything did.
using WriteFile = std::function<std::error_code(const std::filesystem::path&, std::string_view)>;

/// What copying needs of the system.
struct DriveActions {
  WriteFile write;
  std::function<void(std::chrono::milliseconds)> sleep;
  std::function<std::chrono::milliseconds()> now;
  /// The board runs again: a drive that was mounted by hand may still seem to be there.
  std::function<bool()> board_is_back;
};

/// Writes by the system's calls.
std::error_code write_through(const std::filesystem::path& file, std::string_view bytes);

/// Copies and waits until the drive has gone or the board is back. Throws Error: no_device if
/// `folder` is no such drive, job_failed if the copy fails or the board does not restart. Gives the
/// error of a write that may have been the restart, or a cable pulled in mid-copy: who sees the
/// board again knows which.
[[nodiscard]] std::error_code copy_to_drive(const std::filesystem::path& folder,
                                            std::string_view uf2, const DriveActions& actions);

}  // namespace lamplock::flash
