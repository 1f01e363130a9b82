#include "host/program/program_error.hpp"

#include <fmt/format.h>

#include <utility>

namespace lamplock::program_run {

std::string text_of(const ProgramPlace& place) {
  std::string text = place.file;
  if (place.line != 0) text += fmt::format(":{}", place.line);
  if (place.column != 0) text += fmt::format(":{}", place.column);
  return text;
}

ProgramError::ProgramError(ProgramPlace place, const std::string& what, const std::string& remedy,
                           int number)
    : Error(Exit::bad_input, text_of(place),
            number == 0 ? what : fmt::format("error:{} {}", number, what), remedy),
      place_(std::move(place)),
      number_(number),
      text_(what),
      remedy_(remedy) {}

ProgramError::ProgramError(const Error& cause, std::string file)
    : Error(cause), place_{std::move(file)}, text_(cause.message()) {}

}  // namespace lamplock::program_run
