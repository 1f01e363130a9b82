#include "host/job/rows.hpp"

#include <fmt/format.h>

#include "host/error.hpp"

namespace lamplock::job {

std::size_t continue_at(Rows& rows, std::size_t from) {
  if (from == 0 || from >= rows.lines.size() || !rows.lines[from].to.light) return from;
  Line& before = rows.lines[from - 1];
  if (!before.to.light) return from;
  before.first_run = rows.runs.size();
  before.runs = 1;
  rows.runs.push_back(wire::max_run(0, 1));
  return from - 1;
}

RowEncoder::RowEncoder(const Rows& rows, std::size_t first, const StepPosition& origin, int axes)
    : rows_(&rows), axes_(axes), index_(first) {
  state_.steps = origin;
}

std::vector<std::uint8_t> RowEncoder::next(std::size_t max_bytes, std::size_t max_lines) {
  std::vector<std::uint8_t> payload(max_bytes);
  wire::ByteWriter out(payload);
  const std::size_t last = index_ + max_lines;
  while (index_ < rows_->lines.size() && index_ < last) {
    if (!put_runs(out)) break;
    if (out.room() < wire::max_row_line_size) break;
    if (!wire::put_row_line(out, state_, rows_->lines[index_].to, axes_)) refuse_line();
    ++index_;
    done_runs_ = 0;
  }
  // An empty payload means the end, so a line that never fits must throw.
  if (out.size() == 0 && index_ < rows_->lines.size()) refuse_line();
  payload.resize(out.size());
  return payload;
}

/// Writes the remaining runs of the line; false if not all of them fit.
bool RowEncoder::put_runs(wire::ByteWriter& out) {
  const Line& line = rows_->lines[index_];
  while (done_runs_ < line.runs) {
    const std::size_t count = wire::put_runs(out, state_, rows_->runs_of(line).subspan(done_runs_));
    if (count == 0) return false;
    places_ += count + (done_runs_ == 0 ? 1 : 0);
    done_runs_ += count;
  }
  return true;
}

void RowEncoder::refuse_line() const {
  throw Error(Exit::bad_input, fmt::format("row line {}", index_),
              "the line has zero length, is too long, has too many pixels, or uses an axis that "
              "the machine does not have",
              "make the rows again with lamplock raster and this machine's profile");
}

}  // namespace lamplock::job
