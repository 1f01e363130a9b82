#include "host/gpio/read_line_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <string>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/gpio/line_address.hpp"
#include "host/suggestion.hpp"
#include "host/toml_file.hpp"

namespace lamplock::gpio {
namespace {

/// Contacts bounce for some milliseconds; a longer debounce time would only delay the user.
constexpr std::int64_t max_debounce_ms = 1'000;
/// A beat must be longer than the rounds of a job (20 ms at most), and short for a fast stop.
constexpr std::int64_t min_beat_ms = 20, max_beat_ms = 1'000;

enum class Way : std::uint8_t { input, output, open_drain };

/// A table of the file and its role.
struct Role {
  const char* name;
  std::optional<LineRequest> LineTable::*line;
  Way way;
};
constexpr std::array roles{Role{"estop", &LineTable::estop, Way::input},
                           Role{"door", &LineTable::door, Way::input},
                           Role{"interlock", &LineTable::interlock, Way::output},
                           Role{"lamp", &LineTable::lamp, Way::output},
                           Role{"run", &LineTable::run, Way::open_drain},
                           Role{"bootsel", &LineTable::bootsel, Way::open_drain}};

struct NamedBias {
  const char* name;
  Bias bias;
};
constexpr std::array biases{NamedBias{"as-is", Bias::as_is}, NamedBias{"none", Bias::none},
                            NamedBias{"pull-up", Bias::pull_up},
                            NamedBias{"pull-down", Bias::pull_down}};

[[noreturn]] void fail(const std::string& where, const std::string& what,
                       const std::string& remedy) {
  throw Error(Exit::bad_input, where, what, remedy);
}

/// Reader of one file.
class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}

  LineTable read(const toml::table& root) {
    for (const auto& [key, node] : root) read_key(key, node);
    check_distinct();
    if (table_.interlock_beat.count() != 0 && !table_.interlock)
      fail(file_.string(), "'interlock_beat_ms' has no interlock line", "add [interlock]");
    return table_;
  }

 private:
  std::string place(const toml::source_region& source) const {
    return toml_location(file_, source);
  }

  void read_key(const toml::key& key, const toml::node& node) {
    const std::string where = place(key.source());
    if (key == "debounce_ms") {
      table_.debounce = time_of(key, node, 0, max_debounce_ms);
      return;
    }
    if (key == "interlock_beat_ms") {
      table_.interlock_beat = time_of(key, node, min_beat_ms, max_beat_ms);
      return;
    }
    for (const Role& role : roles)
      if (key == role.name) return read_role(role, node, where);
    std::vector<std::string> names{"debounce_ms", "interlock_beat_ms"};
    for (const Role& role : roles) names.emplace_back(role.name);
    fail(where, fmt::format("unknown key '{}'", key.str()),
         did_you_mean(key.str(), names,
                      "use [estop], [door], [interlock], [lamp], [run], [bootsel], debounce_ms, "
                      "interlock_beat_ms"));
  }

  std::chrono::milliseconds time_of(const toml::key& key, const toml::node& node,
                                    std::int64_t least, std::int64_t most) const {
    const auto ms = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!ms || *ms < least || *ms > most)
      fail(place(key.source()), fmt::format("'{}' must be milliseconds", key.str()),
           fmt::format("give a whole number, {} to {}", least, most));
    return std::chrono::milliseconds(*ms);
  }

  void read_role(const Role& role, const toml::node& node, const std::string& where) {
    const toml::table* keys = node.as_table();
    if (keys == nullptr)
      fail(where, fmt::format("'{}' must be a table", role.name),
           fmt::format("write [{}] and below it line = \"...\"", role.name));
    LineRequest wanted;
    // As on the board: a contact that is closed to ground in the safe state.
    if (role.way == Way::input) wanted.bias = Bias::pull_up;
    // RUN and BOOTSEL have pull-ups on the board, and other circuits may pull them down too.
    if (role.way == Way::open_drain) {
      wanted.drive = Drive::open_drain;
      wanted.active_low = true;
    }
    for (const auto& [key, value] : *keys) read_line_key(role, key, value, wanted);
    if (wanted.place.empty())
      fail(where, fmt::format("[{}] has no line", role.name),
           "add line = \"NAME\" or line = \"gpiochip0:17\"");
    table_.*role.line = wanted;
  }

  void read_line_key(const Role& role, const toml::key& key, const toml::node& value,
                     LineRequest& wanted) const {
    const std::string where = place(key.source());
    if (key == "line") {
      wanted.place = text_of(key, value);
      if (wanted.place.empty()) fail(where, "'line' is empty", "name a line");
    } else if (key == "active_low" && role.way != Way::open_drain) {
      const auto flag = value.is_boolean() ? value.value<bool>() : std::nullopt;
      if (!flag) fail(where, "'active_low' must be true or false", "write it without quotes");
      wanted.active_low = *flag;
    } else if (key == "bias" && role.way == Way::input) {
      wanted.bias = bias_named(text_of(key, value), where);
    } else {
      std::vector<std::string> names{"line"};
      if (role.way != Way::open_drain) names.emplace_back("active_low");
      if (role.way == Way::input) names.emplace_back("bias");
      fail(where, fmt::format("unknown key '{}' of [{}]", key.str(), role.name),
           did_you_mean(key.str(), names, fmt::format("use {}", fmt::join(names, ", "))));
    }
  }

  std::string text_of(const toml::key& key, const toml::node& value) const {
    const auto text = value.is_string() ? value.value<std::string>() : std::nullopt;
    if (!text)
      fail(place(key.source()), fmt::format("'{}' must be a text", key.str()),
           "write it in quotes");
    return *text;
  }

  static Bias bias_named(const std::string& name, const std::string& where) {
    std::vector<std::string> names;
    for (const NamedBias& known : biases) {
      if (name == known.name) return known.bias;
      names.emplace_back(known.name);
    }
    fail(where, fmt::format("unknown bias '{}'", name),
         did_you_mean(name, names, "use pull-up, pull-down, none or as-is"));
  }

  /// A name and a number may still mean the same line: the system refuses the second request then.
  void check_distinct() const {
    for (const Role& a : roles)
      for (const Role& b : roles) {
        const auto &one = table_.*a.line, &other = table_.*b.line;
        if (&a == &b || !one || !other || !same_place(one->place, other->place)) continue;
        fail(file_.string(), fmt::format("[{}] and [{}] are both {}", a.name, b.name, one->place),
             "give each a line of its own");
      }
  }

  static bool same_place(const std::string& a, const std::string& b) {
    const LineAddress one = parse_line_address(a), other = parse_line_address(b);
    return one.name == other.name && one.chip == other.chip && one.number == other.number;
  }

  std::filesystem::path file_;
  LineTable table_{};
};

}  // namespace

LineTable parse_line_table(std::string_view text, const std::filesystem::path& file) {
  return Reader(file).read(parse_toml(text, file));
}

LineTable read_machine_lines(const std::filesystem::path& profile) {
  const toml::table root = read_toml(profile);
  const auto lines = root.find("lines");
  if (lines == root.end()) return {};
  const toml::table* table = lines->second.as_table();
  if (table == nullptr)
    fail(toml_location(profile, lines->first.source()), "'lines' must be a table",
         "write [lines.estop] and below it line = \"...\"");
  return Reader(profile).read(*table);
}

LineTable read_line_table(const std::filesystem::path& file) {
  return parse_line_table(read_text_file(file), file);
}

}  // namespace lamplock::gpio
