#include "host/program/interpreter_options.hpp"

#include "firmware/machine/inputs/input_wait.hpp"
#include "shared/boards/all_boards.hpp"

namespace lamplock::program_run {
namespace {

machine::ProgramPorts ports_of(const settings::Values& values) {
  const auto map = static_cast<boards::PinMap>(values.whole(settings::Id::pin_map));
  const bool has_input = boards::find_gpio(map, boards::Role::aux_in).has_value();
  return {boards::program_outputs(map),
          machine::program_inputs(machine::set_of(machine::Input::probe) |
                                  (has_input ? machine::set_of(machine::Input::aux) : 0u))};
}

}  // namespace

program::Options program_options(const settings::Values& values) {
  return machine::program_options(values, true, ports_of(values));
}

}  // namespace lamplock::program_run
