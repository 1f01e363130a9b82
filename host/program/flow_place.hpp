// The place of a statement in a program with O-words, for its errors.
//
// In:  a statement, and the line of the program that has called its file. Out: errors with the
//      place in the file, the values of the material in a text of the statement.
// Who: program_flow.cpp.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/program/interpreter.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/process_values.hpp"
#include "host/program/program_error.hpp"

namespace lamplock::program_run {

/// What process parameters are replaced by.
struct FlowProcess {
  const ProcessValues* values = nullptr;  ///< of the material; null: none is chosen
  double max_speed_s = 0;                 ///< S word of full power
};

/// All functions throw ProgramError about the statement.
class FlowPlace {
 public:
  /// `program_line`: of the program, also for a statement of another file. The unit must outlive
  /// it.
  FlowPlace(const FlowUnit& unit, std::size_t statement, std::size_t program_line)
      : unit_(unit), line_(unit.statements[statement].line), program_line_(program_line) {}

  ProgramPlace place(std::size_t column = 0) const { return {unit_.file, line_.number, column}; }

  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const {
    refuse_at(0, what, remedy, 0);
  }
  /// For a fault, if it is one, of a text that begins at this index of the statement without its
  /// blanks; without the index the text is the statement.
  void refuse_fault(std::string_view text, const program::Fault& fault,
                    const program::Interpreter& interpreter,
                    std::optional<std::size_t> index = {}) const;
  /// For a text that reads the result of a probe or of M66.
  void refuse_results(std::string_view text) const;

  /// The statement, a value of it or its messages, with the values of the material.
  std::string line_with(const FlowProcess& process, bool inches) const;
  std::string value_with(const FlowProcess& process, bool inches, const std::string& value,
                         std::size_t index) const;
  std::string messages_with(const FlowProcess& process, bool inches) const;

  /// Runs `read`; its ProgramError gets the line of the program.
  template <class Read>
  auto with_line(const Read& read) const {
    try {
      return read();
    } catch (ProgramError& error) {
      error.set_program_line(program_line_);
      throw;
    }
  }

 private:
  [[noreturn]] void refuse_at(std::size_t column, const std::string& what,
                              const std::string& remedy, int number) const;
  std::size_t column_of(std::size_t index, std::size_t column) const;
  std::string with(const FlowProcess& process, bool inches, const std::string& text,
                   const std::function<std::size_t(std::size_t)>& column) const;

  const FlowUnit& unit_;
  const link::ProgramLine& line_;
  std::size_t program_line_;
};

}  // namespace lamplock::program_run
