#include "host/cli/terminal_width.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

#include "host/text.hpp"

namespace lamplock::cli {

std::size_t terminal_width() {
  constexpr std::size_t usual_columns = 80;  // of a terminal that reports none (VT100)
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* const columns = std::getenv("COLUMNS");
  if (columns == nullptr) return usual_columns;
  const auto number = number_of<std::size_t>(columns);
  return number && *number > 0 ? *number : usual_columns;
}

}  // namespace lamplock::cli
