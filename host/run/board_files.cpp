#include "host/run/board_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "host/output_error.hpp"
#include "host/report/files.hpp"
#include "host/report/report.hpp"
#include "host/units.hpp"
#include "sim/world/world.hpp"

namespace lamplock::run {

namespace {

/// The error of a file to which a stream could not write: streams do not keep the reason, so a
/// block is appended, which fails for the same reason.
[[noreturn]] void throw_write_error(const StagedFile& file) {
  constexpr std::array<char, 4096> block{};
  const int descriptor = ::open(file.path().c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  int error = descriptor < 0 ? errno : 0;
  if (error == 0 && ::write(descriptor, block.data(), block.size()) < 0) error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (error != 0) throw OutputError(file.target(), error);
  throw OutputError(file.target(), "cannot be written");
}

}  // namespace

PinTrace::PinTrace(const std::filesystem::path& file, sim::Board& board)
    : board_(board),
      file_(file),
      stream_(file_.path(), std::ios::binary),
      writer_(stream_, board.bus()) {
  if (!stream_) throw OutputError(file_.target(), errno);
}

void PinTrace::finish() {
  writer_.finish(board_.now());
  stream_.close();
  if (!stream_) throw_write_error(file_);
  file_.commit();
}

PerAxis<double> steps_per_mm(const settings::Values& values) {
  PerAxis<double> result{};
  for (int axis = 0; axis < max_axes; ++axis)
    result[index(axis)] = in_units(values, settings::Id::steps_per_mm_x, axis);
  return result;
}

void write_shots(const std::filesystem::path& file, const sim::Board& board,
                 const settings::Values& values) {
  write_whole(file, [&](const std::filesystem::path& path) {
    report::write_shots_csv(board.world().laser().shots(), steps_per_mm(values), path);
  });
}

}  // namespace lamplock::run
