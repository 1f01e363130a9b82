// docs/wiring.md equals the table of pins, pin by pin, for every map.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/boards/rp2040/base/watchdog.hpp"
#include "firmware/boards/rp2040/lattice/tick_feed.hpp"
#include "host/job/read_profile.hpp"
#include "host/text.hpp"
#include "shared/boards/all_boards.hpp"
#include "shared/units.hpp"
#include "tests/docs/page.hpp"
#include "tests/docs/wiring_picture.hpp"

namespace lamplock::boards {
namespace {

using Row = std::vector<std::string>;

/// Rows of the first table after a heading, without its two head lines.
std::vector<Row> table_of(const std::string& page, const std::string& heading) {
  const std::size_t begin = page.find("\n## " + heading);
  if (begin == std::string::npos) return {};
  std::istringstream lines(page.substr(begin + 1));
  std::string line;
  std::getline(lines, line);
  std::vector<Row> rows;
  while (std::getline(lines, line) && line.rfind("## ", 0) != 0) {
    if (line.rfind('|', 0) != 0) continue;
    std::istringstream cells(line.substr(1));
    Row row;
    for (std::string cell; std::getline(cells, cell, '|');) row.emplace_back(trimmed(cell));
    rows.push_back(row);
  }
  if (rows.size() > 1) rows.erase(rows.begin(), rows.begin() + 2);
  return rows;
}

/// Pins of the Pico's two rows of contacts (Raspberry Pi Pico Datasheet, 2.1); 0 = not connected.
constexpr std::array<int, 30> contacts{1,  2,  4,  5,  6,  7,  9,  10, 11, 12, 14, 15, 16, 17, 19,
                                       20, 21, 22, 24, 25, 26, 27, 29, 0,  0,  0,  31, 32, 34, 0};

/// Level at rest: a released switch is closed to ground; signals that idle high are named.
std::string off_level(const PinUse& use) {
  switch (use.role) {
    case Role::drives_enable:
    case Role::probe:
    case Role::uart_tx:
    case Role::uart_rx:
    case Role::aux_in:
    case Role::z_enable:
      return "high";
    default:
      return "low";
  }
}

std::string name_of(PinMap map) {
  if (map == PinMap::glass) return "glass";
  return map == PinMap::cut ? "cut" : "cut_io";
}

class WiringMap : public testing::TestWithParam<PinMap> {};

TEST_P(WiringMap, ThePageHasEveryPinOfTheTable) {
  const std::string heading = "Pin map " + name_of(GetParam()) + ":";
  const std::vector<Row> rows = table_of(test::read_repository_file("docs/wiring.md"), heading);
  const Pins table = pins(GetParam());
  ASSERT_EQ(rows.size(), table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const PinUse& use = table[i];
    const int contact = contacts[use.gpio];
    ASSERT_EQ(rows[i].size(), 7u) << use.name;
    EXPECT_EQ(rows[i][0], std::to_string(use.gpio)) << use.name;
    EXPECT_EQ(rows[i][1], contact == 0 ? "-" : std::to_string(contact)) << use.name;
    EXPECT_EQ(rows[i][2], use.name);
    EXPECT_EQ(rows[i][3], use.direction == Direction::output ? "out" : "in") << use.name;
    EXPECT_EQ(rows[i][4], use.energy ? "yes" : "") << use.name;
    EXPECT_EQ(rows[i][5], off_level(use)) << use.name;
    EXPECT_NE(rows[i][6], "") << use.name;
  }
}

/// "12, 16" as numbers.
std::vector<int> numbers_of(const std::string& cell) {
  std::istringstream parts(cell);
  std::vector<int> numbers;
  for (std::string part; std::getline(parts, part, ',');) numbers.push_back(std::stoi(part));
  return numbers;
}

/// True for the ground contacts of the Pico (Raspberry Pi Pico Datasheet, 2.1).
bool is_ground(int contact) {
  constexpr std::array<int, 7> grounds{3, 8, 13, 18, 23, 28, 38};
  return std::find(grounds.begin(), grounds.end(), contact) != grounds.end();
}

TEST(Wiring, OfAFirstJobEqualsTheMapOfANewBoard) {
  const std::vector<Row> rows =
      table_of(test::read_repository_file("docs/wiring.md"), "A first job");
  ASSERT_EQ(rows.size(), 8u);
  std::size_t grounds = 0;
  for (const Row& row : rows) {
    ASSERT_EQ(row.size(), 4u) << row[0];
    const std::vector<int> pins_there = numbers_of(row[0]);
    if (row[1] == "-") {
      for (const int pin : pins_there) EXPECT_TRUE(is_ground(pin)) << pin;
      ++grounds;
      continue;
    }
    const std::vector<int> gpios = numbers_of(row[1]);
    ASSERT_EQ(gpios.size(), pins_there.size()) << row[0];
    std::string names;
    for (std::size_t i = 0; i < gpios.size(); ++i) {
      EXPECT_EQ(contacts.at(static_cast<std::size_t>(gpios[i])), pins_there[i]) << row[0];
      for (const PinUse& use : pins(PinMap::glass))
        if (use.gpio == gpios[i]) names += (names.empty() ? "" : ", ") + std::string(use.name);
    }
    EXPECT_EQ(row[2], names);
  }
  EXPECT_EQ(grounds, 1u);
}

/// Boards other than the Pico wired by hand have a page each.
TEST(BoardPages, HaveEveryPinOfTheRow) {
  for (const BoardRow* row : all_boards) {
    const std::string page =
        test::read_repository_file("docs/boards/" + std::string(row->name) + ".md");
    EXPECT_NE(page.find("lamplock flash --for " + std::string(row->name)), std::string::npos);
    EXPECT_NE(page.find("[BOARD:" + std::string(row->name) + "]"), std::string::npos);
    if (row == &pico) continue;
    const std::vector<Row> rows = table_of(page, "Pins");
    const Pins table = row->maps[0].pins;
    ASSERT_EQ(rows.size(), table.size()) << row->name;
    for (std::size_t i = 0; i < table.size(); ++i) {
      ASSERT_EQ(rows[i].size(), 5u) << row->name << ' ' << table[i].name;
      EXPECT_EQ(rows[i][0], std::to_string(table[i].gpio)) << row->name << ' ' << table[i].name;
      EXPECT_EQ(rows[i][1], table[i].name) << row->name;
      EXPECT_EQ(rows[i][2], table[i].direction == Direction::output ? "out" : "in") << rows[i][1];
      EXPECT_EQ(rows[i][3], table[i].energy ? "yes" : "") << rows[i][1];
      EXPECT_NE(rows[i][4], "") << row->name << ' ' << table[i].name;
    }
    const std::string map = std::to_string(static_cast<int>(row->first_map));
    EXPECT_NE(page.find("pin_map = " + map + "`"), std::string::npos) << row->name;
  }
}

/// Lines of a text that a search for one of the words would show.
std::size_t lines_with(const std::string& text, const std::vector<std::string>& words) {
  std::istringstream lines(text);
  std::size_t found = 0;
  for (std::string line; std::getline(lines, line);)
    found += std::any_of(words.begin(), words.end(), [&line](const std::string& word) {
      return line.find(word) != std::string::npos;
    });
  return found;
}

/// To add a board takes its row, two lines in the list of boards and its page: no code asks for a
/// board by its name. (The Pico wired by hand is the default of the build and of the simulators.)
TEST(BoardRows, AreTheOnlyCodeThatNamesABoard) {
  namespace fs = std::filesystem;
  for (const BoardRow* row : all_boards) {
    if (row == &pico) continue;
    const std::string name(row->name);
    std::string identifier = name;
    std::replace(identifier.begin(), identifier.end(), '-', '_');
    const std::string own = "shared/boards/rows/" + identifier + ".hpp",
                      list = "shared/boards/all_boards.hpp";
    EXPECT_EQ(lines_with(test::read_repository_file(list), {name, identifier}), 2u) << name;
    EXPECT_GT(lines_with(test::read_repository_file(own), {name, identifier}), 0u) << name;
    for (const char* room : {"firmware", "shared", "host", "sim", "toolchain"})
      for (const auto& entry : fs::recursive_directory_iterator(test::in_repository(room))) {
        const std::string file =
            fs::relative(entry.path(), test::in_repository("")).generic_string();
        // A row may share pins with another one.
        if (!entry.is_regular_file() || file == list || file.starts_with("shared/boards/rows/"))
          continue;
        EXPECT_EQ(lines_with(test::read_repository_file(file), {name, identifier}), 0u)
            << file << " names " << name;
      }
  }
}

/// A picture that differs is written into the folder of the build, to be looked at and copied.
TEST(BoardPages, ShowThePictureOfTheRow) {
  for (const BoardRow* row : all_boards) {
    const std::string name = "docs/boards/" + std::string(row->name);
    const std::string picture = test::WiringPicture(*row).text();
    EXPECT_NE(test::read_repository_file(name + ".md").find(std::string(row->name) + ".svg)"),
              std::string::npos)
        << row->name;
    if (test::read_repository_file(name + ".svg") == picture) continue;
    const std::string wanted = test::in_build(std::string(row->name) + ".svg");
    std::ofstream(wanted) << picture;
    ADD_FAILURE() << name << ".svg differs from " << wanted;
  }
}

/// The settings to start with are those of the board, and can be read.
TEST(BoardPages, HaveSettingsToStartWith) {
  for (const BoardRow* row : all_boards) {
    if (row == &pico) continue;
    const std::string name = "docs/boards/" + std::string(row->name) + ".toml";
    const job::Profile profile = job::read_profile(test::in_repository(name));
    EXPECT_EQ(profile.settings.whole(settings::Id::pin_map), static_cast<int>(row->first_map));
    if (!row->drives) continue;
    for (int axis = 0; axis < 4; ++axis)
      EXPECT_LE(profile.settings.whole(settings::Id::drive_current_x, axis),
                row->drives->max_current_ma);
  }
}

TEST(Safety, ThePageHasTheTimesOfTheFirmware) {
  const std::string page = test::read_repository_file("docs/safety.md");
  std::ostringstream ahead;
  ahead << "ticks are credits, " << rp2040::feed_lead_clocks / clocks_per_us
        << " us ahead and at most one span of " << rp2040::feed_span_ticks << " ticks more";
  EXPECT_NE(page.find(ahead.str()), std::string::npos) << ahead.str();
  static_assert(rp2040::feed_lead_clocks + rp2040::feed_span_ticks * clocks_per_tick <=
                1000 * clocks_per_us);
  std::ostringstream restart;
  restart << "restart " << rp2040::Watchdog::timeout_us / 1e6 << " s (";
  EXPECT_NE(page.find(restart.str()), std::string::npos) << restart.str();
}

INSTANTIATE_TEST_SUITE_P(Maps, WiringMap,
                         testing::Values(PinMap::glass, PinMap::cut, PinMap::cut_io),
                         [](const auto& map) { return name_of(map.param); });

}  // namespace
}  // namespace lamplock::boards
