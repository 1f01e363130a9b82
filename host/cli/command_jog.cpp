// `lamplock jog`: move a machine by hand, with keys or a pendant.
#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/jog_screen.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/pendant/read_key_map.hpp"
#include "host/run/jog_session.hpp"

namespace lamplock::cli {
namespace {

struct JogOptions : run::BoardChoice {
  bool json = false;
  std::string pendant = "auto";
  std::optional<std::string> mode;
  std::optional<double> feed_mm_min, step_mm;
};

/// In the order of pendant::Mode.
constexpr std::array mode_names{"step", "continuous", "feed"};

run::JogChoice choice_of(const JogOptions& options) {
  run::JogChoice choice;
  choice.pendant = options.pendant;
  choice.map = options.machine.machine.empty() ? pendant::default_key_map()
                                               : pendant::read_key_map(options.machine.machine);
  if (options.feed_mm_min) choice.map.feed_mm_min = *options.feed_mm_min;
  // A step that the list does not have joins it.
  if (options.step_mm) {
    auto& steps = choice.map.steps_mm;
    steps.insert(std::upper_bound(steps.begin(), steps.end(), *options.step_mm), *options.step_mm);
  }
  choice.step_mm = options.step_mm;
  if (options.mode) {
    const auto* name = std::find(mode_names.begin(), mode_names.end(), *options.mode);
    choice.mode = static_cast<pendant::Mode>(name - mode_names.begin());
  }
  return choice;
}

Json document_of(const run::JogSession& session) {
  const pendant::Jogger& jogger = session.jogger();
  const pendant::MachineNow& machine = jogger.machine();
  return {{"pendant", session.pendant_name()},  {"state", machine.status.state},
          {"machine_mm", machine.place(false)}, {"work_mm", machine.place(true)},
          {"lines", jogger.counts().lines},     {"cancels", jogger.counts().cancels},
          {"refused", jogger.counts().refused}};
}

Exit jog(const JogOptions& options) {
  Console console(options.json);
  const run::JogChoice choice = choice_of(options);
  run::SupervisedBoard board(options);
  JogScreen screen(console);
  run::JogSession session(board, choice, console, screen);
  session.run();
  console.document(document_of(session));
  return session.interrupted() ? Exit::interrupted : Exit::done;
}

std::vector<std::string> pendant_names() {
  std::vector<std::string> names{"auto", "none"};
  for (const pendant::PendantId& id : pendant::pendant_ids) names.emplace_back(id.option);
  return names;
}

void add_options(Command& app, const std::shared_ptr<JogOptions>& options) {
  app.add_option("--pendant", &options->pendant,
                 "auto: the first pendant that is connected; none: keys only")
      .check(one_of(pendant_names()))
      .value_name("auto|none|hb04|whb04b|shuttlexpress|shuttlepro")
      .show_default();
  app.add_option("--mode", &options->mode,
                 "Mode of wheel and keys at the start; continuous: the machine moves while a key "
                 "is held; default: step with a pendant, otherwise continuous")
      .check(one_of({mode_names.begin(), mode_names.end()}))
      .value_name("step|continuous|feed");
  constexpr double least = 0.001, max_step_mm = 100, max_feed = 1e6;
  app.add_option("--feed", &options->feed_mm_min,
                 "Feed rate of jogs; default: feed rate in [pendant] of the machine profile, "
                 "otherwise 3000")
      .check(number_in({least, max_feed}))
      .value_name("MM_MIN");
  app.add_option("--step", &options->step_mm, "Step length at the start; default: 0.1")
      .check(number_in({least, max_step_mm}))
      .value_name("MM");
  app.add_json(options->json);
}

}  // namespace

void add_jog(Command& program) {
  Command& app = program.add_command("jog", "Move the machine by hand, with keys or a USB pendant");
  app.footer(
      "Keys that move: arrows (X and Y), PgUp and PgDn (Z), comma and full stop (A). A key "
      "pressed\n"
      "once moves one step; in the mode continuous a held key moves until it is released.\n"
      "Other keys: + - step length, m mode, x y z a select an axis, 0 set its zero here,\n"
      "g go to zero, h home, u unlock, ! hold, ~ resume, Ctrl-X reset, space or Esc stop, q quit.\n"
      "If the pendant is lost, jog stops all motion that it has started; homing ends with a\n"
      "reset. If the program or the cable fails, continuous jogging stops by itself; a single\n"
      "move, homing or the current line of a macro is completed.\n"
      "The table [pendant] of --machine defines keys, pendants and macros (docs/pendants.md).\n"
      "Example:\n"
      "  lamplock jog --board /dev/ttyACM0 --step 0.01\n"
      "  lamplock jog --board virtual --pendant none");
  const auto options = std::make_shared<JogOptions>();
  add_board_choice(app, options->board);
  add_machine(app, options->machine);
  add_options(app, options);
  app.action([options] {
    options->board.profile = options->machine.machine;
    return jog(*options);
  });
}

}  // namespace lamplock::cli
