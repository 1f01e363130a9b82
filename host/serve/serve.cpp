#include "host/serve/serve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/run/board_port.hpp"
#include "host/serve/access.hpp"
#include "host/serve/hashes.hpp"
#include "host/serve/log_file.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/paced_transport.hpp"
#include "host/serve/page_texts.hpp"
#include "host/serve/server.hpp"
#include "sim/world/limit_settings.hpp"
#include "sim/world/world.hpp"

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;

/// Clients get what differs in this interval.
constexpr auto tick_interval = 50ms;

BoardOpener opener_of(const ServeOptions& options) {
  const run::BoardOptions& board = options.board;
  if (!board.is_simulated()) return [board] { return run::open_port(board); };
  const settings::Values values = options.machine.profile().settings;
  return [board, values]() -> std::unique_ptr<link::Transport> {
    sim::WorldConfig world;
    world.lamp = board.faults.lamp(values);
    world.drives = board.drives.drives(values);
    world.switches = sim::limits_of(values);
    return std::make_unique<PacedTransport>(
        run::make_board(board.board, board.image, values, world, board.usb_function()));
  };
}

/// The first connection is made here: an error of it ends the program with its message.
BoardOpener opened_once(const BoardOpener& open) {
  const auto first = std::make_shared<std::unique_ptr<link::Transport>>(open());
  return [open, first] { return *first ? std::exchange(*first, nullptr) : open(); };
}

/// A page of this computer can use it.
std::string origin_of(const std::string& address, std::uint16_t port) {
  if (address == "0.0.0.0" || address == "::") return origin_of(loopback_address, port);
  return "http://" + authority_of(address, port);
}

std::string read_password_hash(const std::string& file) {
  std::string text = read_file(file);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (!is_password_hash(text))
    throw Error(Exit::bad_input, file, "is not the hash of a password",
                "make one: lamplock serve --set-password FILE");
  return text;
}

/// Makes the file if there is none: slicers keep the key.
std::string read_or_make_key(const std::string& file) {
  if (!std::filesystem::exists(file))
    write_whole(file, [](const std::filesystem::path& path) {
      write_file(path, random_token() + "\n");
      std::filesystem::permissions(
          path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    });
  std::string text = read_file(file);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  constexpr std::size_t min_key = 16, max_key = 64;
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0;
  });
  if (!is_plain || text.size() < min_key || text.size() > max_key)
    throw Error(Exit::bad_input, file, "is not a key of 16 to 64 letters and digits",
                "name a file that does not exist, to have one made");
  return text;
}

/// Who can reach the server needs the token or the password.
void set_access(const ServeOptions& options, SiteOptions& site) {
  site.token = random_token();
  if (options.pairs) site.code = random_code();
  if (!options.password.empty()) site.password_hash = read_password_hash(options.password);
  if (!options.octoprint.empty()) site.octoprint_key = read_or_make_key(options.octoprint);
  if (!options.proxy.empty()) {
    site.proxy = parse_origin(options.proxy);
    if (!site.proxy)
      throw Error(Exit::bad_input, "--proxy", options.proxy + " is not an origin",
                  "give one such as https://laser.example.org, without a path");
  }
  const bool is_reachable = !is_loopback(options.address) || site.proxy;
  if (is_reachable && site.password_hash.empty())
    throw Error(Exit::bad_input, site.proxy ? "--proxy" : "--listen",
                "other computers could reach the machine without a password",
                "make one: lamplock serve --set-password FILE; then add --password FILE");
}

}  // namespace

void write_password(const std::string& file, const std::string& password) {
  if (password.size() < min_password || password.size() > max_password)
    throw Error(Exit::bad_input, "password", "its length is wrong",
                fmt::format("use {} to {} bytes", min_password, max_password));
  write_whole(file, [&](const std::filesystem::path& path) {
    write_file(path, password_hash(password) + "\n");
    std::filesystem::permissions(
        path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  });
}

void serve(const ServeOptions& options, run::Frontend& frontend) {
  options.board.check();
  options.board.line_table();
  run::check_image(options.board.board, options.board.image);
  SiteOptions site;
  site.board = options.board.board;
  site.is_simulated = options.board.is_simulated();
  set_access(options, site);
  std::optional<LogFile> log;
  if (!options.log.empty()) log.emplace(options.log);
  const Note note = [&](const std::string& line) {
    if (log && !log->add(line)) frontend.notice(options.log + ": a line could not be written");
  };
  site.note = note;
  site.machine = options.machine;
  site.library = options.library;
  site.camera = options.camera;
  if (!options.texts.empty()) site.texts = read_texts(options.texts);
  const JobFolder folder(options.folder.empty() ? default_job_folder()
                                                : std::filesystem::path(options.folder));
  const BoardOpener open = opened_once(opener_of(options));
  Server server(site, folder);
  WebServer web(options.address, static_cast<std::uint16_t>(options.port), server);
  Machine machine(open, options.board, options.machine);
  server.use(web, machine);
  // The reader of the address may end the server at once.
  const auto interrupts = frontend.interrupts();
  frontend.say("page: {}/#token={}", origin_of(options.address, web.port()), site.token);
  if (!site.password_hash.empty()) frontend.say("other pages log in with the password");
  if (options.pairs) frontend.say("code for pairing: {}", site.code);
  if (!options.octoprint.empty())
    frontend.say("programs for OctoPrint use the key in {}", options.octoprint);
  frontend.require_output();
  note("the server begins");
  std::uint64_t logged = 0;
  web.run(tick_interval, [&] {
    server.tick();
    for (const ConsoleLine& line : machine.lines_after(logged)) {
      note(line.text);
      logged = line.number;
    }
    if (interrupts->count() > 0) web.stop();
  });
  machine.end();
  server.end();
  note("the server ends");
}

}  // namespace lamplock::serve
