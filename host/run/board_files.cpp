#include "host/run/board_files.hpp"

#include <cerrno>

#include "host/output_error.hpp"
#include "host/report/files.hpp"
#include "host/report/report.hpp"
#include "host/units.hpp"
#include "sim/world/world.hpp"

namespace lamplock::run {

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
  if (!stream_) throw OutputError(file_.target(), errno);
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
