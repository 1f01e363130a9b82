// Flashes without access to USB: copies the image to RPI-RP2, the drive of the boot loader.
//
// In:  folders; the bytes of a UF2 file. Out: a copy, and whether the board has accepted it.
// Who: Update, without permission for the loader itself; `flash --drive`.
//
// The drive disappears during the last write when the board restarts (RP2040 datasheet, 2.8.4), so
// that an error of this write may mean success.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string_view>
#include <system_error>
#include <vector>

namespace lamplock::flash {

/// Folders in which desktops mount drives, directly or in a folder for each user.
std::vector<std::filesystem::path> usual_drive_roots();

/// True for the drive of an RP2040's boot loader, by its INFO_UF2.TXT.
bool is_loader_drive(const std::filesystem::path& folder);

/// The mounted drives of loaders, by path.
std::vector<std::filesystem::path> find_loader_drives(
    const std::vector<std::filesystem::path>& roots);

/// Writes a file through to the device; returns the error, if any.
using WriteFile = std::function<std::error_code(const std::filesystem::path&, std::string_view)>;

/// System functions for copying.
struct DriveActions {
  WriteFile write;
  std::function<void(std::chrono::milliseconds)> sleep;
  std::function<std::chrono::milliseconds()> now;
  /// The board runs again: a drive that was mounted by hand may stay visible.
  std::function<bool()> board_is_back;
};

/// Writes by the system's calls.
std::error_code write_through(const std::filesystem::path& file, std::string_view bytes);

/// Copies and waits until the drive has disappeared or the board is back. Throws Error: no_device
/// if `folder` is no such drive, job_failed if the copy fails or the board does not restart.
/// Returns the error of a write that may have been caused by the restart, or by a cable pulled in
/// mid-copy: the caller decides by whether the board is back.
[[nodiscard]] std::error_code copy_to_drive(const std::filesystem::path& folder,
                                            std::string_view uf2, const DriveActions& actions);

}  // namespace lamplock::flash
