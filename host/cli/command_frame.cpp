// `lamplock frame`: shows where the object will be.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/documents.hpp"
#include "host/cli/engraving_options.hpp"
#include "host/cli/origin.hpp"
#include "host/cli/validators.hpp"
#include "host/run/frame.hpp"
#include "host/run/report_job.hpp"

namespace lamplock::cli {
namespace {

struct FrameOptions {
  bool json = false;
  double speed_m_s = run::default_frame_speed_m_s;
  EngravingOptions engraving;
  run::BoardOptions board;
  std::string origin = run::origin_machine;
};

Exit frame(const FrameOptions& options) {
  Console console(options.json);
  run::JobRequest request = options.engraving.request();
  request.origin = options.origin;
  const run::Framed framed = run::frame(request, options.speed_m_s, options.board, console);
  console.document({{"input", request.input},
                    {"bounds", bounds_json(framed.box)},
                    {"board", options.board.board},
                    {"done", end_name(framed.outcome) == "done"}});
  return run::judge_end(framed.outcome, options.board, "point", console);
}

}  // namespace

void add_frame(Command& program) {
  Command& app = program.add_command("frame",
                                     "Move around the bounding rectangle of the object, at the "
                                     "height of its top, with the laser off");
  app.footer("Example:\n  lamplock frame model.stl --size 40 --board /dev/ttyACM0");
  const auto options = std::make_shared<FrameOptions>();
  options->engraving.add_place(app, true);
  app.add_option("--speed", &options->speed_m_s,
                 "Maximum speed; the limits of the axes still apply")
      .check(number_from(0, false))
      .value_name("M_S")
      .show_default()
      .group("Machine");
  add_origin(app, options->origin);
  add_board_choice(app, options->board);
  add_job_speed(app, options->board);
  app.add_json(options->json).group("Board");
  app.action([options] { return frame(*options); });
}

}  // namespace lamplock::cli
