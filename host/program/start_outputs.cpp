#include "host/program/start_outputs.hpp"

#include <fmt/format.h>

#include <utility>

namespace lamplock::program_run {
namespace {

using program::Action;
using program::ActionKind;
using program::IoRequest;

bool is_motion(ActionKind kind) {
  return kind == ActionKind::move || kind == ActionKind::pixels || kind == ActionKind::probe;
}

std::string output_word(const IoRequest& io, bool at_once) {
  constexpr double percent = 100;
  if (io.level == IoRequest::on) return fmt::format("M{} P{}", at_once ? 64 : 62, io.port);
  if (io.level == 0) return fmt::format("M{} P{}", at_once ? 65 : 63, io.port);
  return fmt::format("M{} E{} Q{:.4f}", at_once ? 68 : 67, io.port,
                     percent * io.level / IoRequest::on);
}

}  // namespace

void StartOutputs::pass(const Action& action) {
  if (action.kind == ActionKind::output)
    (action.io.at_once ? in_force_ : waiting_) = action.io;
  else if (action.kind == ActionKind::program_end)
    in_force_ = waiting_ = std::nullopt;
  else if (is_motion(action.kind) && waiting_)
    in_force_ = std::exchange(waiting_, std::nullopt);
}

void StartOutputs::add_lines(std::vector<std::string>& lines) const {
  if (in_force_) lines.push_back(output_word(*in_force_, true));
  if (waiting_) lines.push_back(output_word(*waiting_, false));
}

}  // namespace lamplock::program_run
