#include "host/program/block_outputs.hpp"

#include <cmath>

#include "host/program/interpreter_options.hpp"

namespace lamplock::program_run {

namespace {

/// A level is 1 / 65535 beside its percentage.
double rounded(double share) {
  constexpr double decimals = 1e4;
  return std::round(share * decimals) / decimals;
}

}  // namespace

BlockOutputs::BlockOutputs(const settings::Values& values, const BoardState* state)
    : options_(program_options(values)) {
  if (state != nullptr) begin_with(*state, interpreter_, parameters_);
}

void BlockOutputs::run(std::string_view line) {
  if (line.starts_with('$') || interpreter_.run(line)) return;
  for (program::Action action; interpreter_.next(action);) {
    if (action.kind == program::ActionKind::output)
      aux_ = rounded(static_cast<double>(action.io.level) / program::IoRequest::on);
    if (action.kind == program::ActionKind::program_end) aux_ = 0;
  }
}

double BlockOutputs::speed_s() const {
  constexpr double milli = 1e3;
  return interpreter_.modal().speed_milli / milli;
}

}  // namespace lamplock::program_run
