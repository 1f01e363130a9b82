#include "host/run/other_board.hpp"

#include <fmt/format.h>

#include "host/error.hpp"
#include "shared/boards/all_boards.hpp"

namespace lamplock::run {

using settings::Id;

void refuse_file_of_other_board(const std::string& file, int pin_map,
                                const link::BoardSettings& board) {
  if (!board.has(Id::pin_map)) return;
  const int own_map = board.values.whole(Id::pin_map);
  const boards::BoardRow *wanted = boards::find_board(static_cast<boards::PinMap>(pin_map)),
                         *own = boards::find_board(static_cast<boards::PinMap>(own_map));
  if (wanted == own || wanted == nullptr || own == nullptr) return;
  throw Error(
      Exit::bad_input, file,
      fmt::format("is for the board {} (pin_map = {}), the connected one is {} (pin_map = {})",
                  wanted->name, pin_map, own->name, own_map),
      fmt::format("use a file of {}, or that board", own->name));
}

void refuse_backup_of_other_board(const std::string& file, const std::vector<link::Change>& changes,
                                  const link::BoardSettings& board) {
  for (const link::Change& change : changes)
    if (change.number == settings::number(Id::pin_map))
      refuse_file_of_other_board(file, std::stoi(change.text), board);
}

}  // namespace lamplock::run
