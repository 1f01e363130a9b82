#include "host/run/other_board.hpp"

#include <fmt/format.h>

#include "host/error.hpp"
#include "shared/boards/all_boards.hpp"

namespace lamplock::run {

void refuse_profile_of_other_board(const std::string& file, const settings::Values& profile,
                                   const link::BoardSettings& board) {
  using settings::Id;
  if (!board.has(Id::pin_map)) return;
  const auto row_of = [](const settings::Values& values) {
    return boards::find_board(static_cast<boards::PinMap>(values.whole(Id::pin_map)));
  };
  const boards::BoardRow *wanted = row_of(profile), *own = row_of(board.values);
  if (wanted == own || wanted == nullptr || own == nullptr) return;
  throw Error(
      Exit::bad_input, file,
      fmt::format("is for the board {} (pin_map = {}), the connected one is {} (pin_map = {})",
                  wanted->name, profile.whole(Id::pin_map), own->name,
                  board.values.whole(Id::pin_map)),
      fmt::format("use a profile of {}, or that board", own->name));
}

}  // namespace lamplock::run
