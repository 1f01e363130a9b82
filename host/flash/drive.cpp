#include "host/flash/drive.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>

#include "host/error.hpp"
#include "host/text.hpp"

namespace lamplock::flash {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr const char* info_file = "INFO_UF2.TXT";
constexpr const char* copy_name = "LAMPLOCK.UF2";  // a name of FAT without extensions
/// The line of the RP2040's loader; the RP2350's loader has another name.
constexpr std::string_view board_line = "Board-ID: RPI-RP2";
/// The ROM writes some 100 KB in a second.
constexpr milliseconds restart_time{20'000}, drive_poll_interval{100};

/// Folders in a folder; none if it may not be read.
std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failure, ignored;
  for (fs::directory_iterator at(folder, failure), end; !failure && at != end;
       at.increment(failure))
    if (at->is_directory(ignored)) found.push_back(at->path());
  std::sort(found.begin(), found.end());
  return found;
}

std::error_code last_error() { return {errno, std::generic_category()}; }

/// Errors of a drive that has disappeared.
bool may_be_restart(const std::error_code& error) {
  return error.value() == EIO || error.value() == ENODEV || error.value() == ENXIO ||
         error.value() == ENOENT;
}

}  // namespace

std::vector<fs::path> usual_drive_roots() { return {"/media", "/run/media", "/mnt", "/Volumes"}; }

bool is_loader_drive(const fs::path& folder) {
  constexpr std::size_t most = 512;  // the ROM's has about 60 bytes
  std::ifstream file(folder / info_file, std::ios::binary);
  std::string text(most, '\0');
  file.read(text.data(), static_cast<std::streamsize>(most));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  std::string_view rest = text;
  while (!rest.empty())
    if (trimmed(take_line(rest)) == board_line) return true;
  return false;
}

std::vector<fs::path> find_loader_drives(const std::vector<fs::path>& roots) {
  std::vector<fs::path> found;
  const auto add_drive = [&](const fs::path& folder) {
    if (!is_loader_drive(folder)) return false;
    found.push_back(folder);
    return true;
  };
  for (const fs::path& root : roots)
    for (const fs::path& folder : folders_in(root))
      if (!add_drive(folder))
        for (const fs::path& below : folders_in(folder)) add_drive(below);
  return found;
}

std::error_code write_through(const fs::path& file, std::string_view bytes) {
  constexpr mode_t everybody_reads = 0644;
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, everybody_reads);
  if (descriptor < 0) return last_error();
  std::error_code failure;
  while (!bytes.empty() && !failure) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0)
      failure = last_error();
    else
      bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (!failure && ::fsync(descriptor) != 0) failure = last_error();
  if (::close(descriptor) != 0 && !failure) failure = last_error();
  return failure;
}

std::error_code copy_to_drive(const fs::path& folder, std::string_view uf2,
                              const DriveActions& actions) {
  if (!is_loader_drive(folder))
    throw Error(Exit::no_device, folder.string(),
                "is not the drive of an RP2040's boot loader (INFO_UF2.TXT with RPI-RP2)",
                "hold BOOTSEL while plugging in and give the folder of the drive RPI-RP2");
  const std::error_code failure = actions.write(folder / copy_name, uf2);
  if (failure && !may_be_restart(failure))
    throw Error(Exit::job_failed, folder.string(),
                "cannot write to the drive: " + failure.message(),
                "check that it is mounted for writing");
  const milliseconds end = actions.now() + restart_time;
  while (is_loader_drive(folder) && !actions.board_is_back()) {
    if (actions.now() >= end)
      throw Error(Exit::job_failed, folder.string(),
                  failure ? "the copy failed: " + failure.message()
                          : "the file was copied but the board did not restart",
                  "unplug the board, hold BOOTSEL while plugging it in, then flash again");
    actions.sleep(drive_poll_interval);
  }
  return failure;
}

}  // namespace lamplock::flash
