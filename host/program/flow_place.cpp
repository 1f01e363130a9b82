#include "host/program/flow_place.hpp"

#include <fmt/format.h>

#include "host/program/line_column.hpp"
#include "host/program/line_fault.hpp"
#include "host/program/machine_results.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {

void FlowPlace::refuse_at(std::size_t column, const std::string& what, const std::string& remedy,
                          int number) const {
  ProgramError error(place(column), what, remedy, number);
  error.set_program_line(program_line_);
  throw error;
}

/// The column in the file of a column of a text that begins at this index without blanks.
std::size_t FlowPlace::column_of(std::size_t index, std::size_t column) const {
  if (column == 0) return 0;
  return column_of_statement(line_, column_without_blanks(line_.text, index + column - 1));
}

void FlowPlace::refuse_fault(std::string_view text, const program::Fault& fault,
                             const program::Interpreter& interpreter,
                             std::optional<std::size_t> index) const {
  if (!fault) return;
  const LineFault seen = describe_fault(text, fault, max_axes, &interpreter);
  // Values of the material keep the columns; a line without its M73 has others.
  const std::string_view whole = line_.text;
  const bool is_statement =
      text.size() == whole.size() || text.substr(0, fault.column) == whole.substr(0, fault.column);
  const std::size_t column = index          ? column_of(*index, fault.column)
                             : is_statement ? column_of_statement(line_, fault.column)
                                            : 0;
  refuse_at(column, seen.text, seen.remedy.empty() ? "correct the value" : seen.remedy,
            static_cast<int>(fault.error));
}

void FlowPlace::refuse_results(std::string_view text) const {
  if (const std::string_view result = result_in(text); !result.empty())
    refuse(fmt::format("{} is not known before the machine runs the program", result),
           "use it in programs without O-words only");
}

std::string FlowPlace::with(const FlowProcess& process, bool inches, const std::string& text,
                            const std::function<std::size_t(std::size_t)>& column) const {
  return with_line([&] {
    return insert_process_values(text, process.values, is_in_inches(text, inches),
                                 process.max_speed_s, {unit_.file, line_.number, column});
  });
}

std::string FlowPlace::line_with(const FlowProcess& process, bool inches) const {
  return with(process, inches, line_.text,
              [this](std::size_t column) { return column_of_statement(line_, column); });
}

std::string FlowPlace::value_with(const FlowProcess& process, bool inches, const std::string& value,
                                  std::size_t index) const {
  return with(process, inches, value,
              [this, index](std::size_t column) { return column_of(index, column); });
}

std::string FlowPlace::messages_with(const FlowProcess& process, bool inches) const {
  return with(process, inches, line_.messages, [](std::size_t) { return std::size_t{0}; });
}

}  // namespace lamplock::program_run
