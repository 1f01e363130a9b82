#include "host/program/kept_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/link/dialog.hpp"
#include "host/program/program_words.hpp"

namespace lamplock::program_run {
namespace {

bool restores_modes(const link::ProgramLine& line) {
  const auto words = words_of(line.text);
  return std::ranges::any_of(words, [](const ProgramWord& word) { return word.is('M', 72); });
}

bool uses_kept_parameters(const std::vector<link::ProgramLine>& lines) {
  return std::ranges::any_of(lines, [](const link::ProgramLine& line) {
    const bool has_parameter =
        line.text.find('#') != std::string::npos || line.messages.find('#') != std::string::npos;
    return has_parameter || restores_modes(line);
  });
}

}  // namespace

std::string clear_kept_parameters(link::LinePort& port, const std::vector<link::ProgramLine>& lines,
                                  const std::string& file) {
  if (!uses_kept_parameters(lines) || link::ask(port, "$RST=P").error == 0) return {};
  return fmt::format(
      "note: {}: the board does not clear the parameters of earlier programs ($RST=P); end them "
      "with M2",
      file);
}

}  // namespace lamplock::program_run
