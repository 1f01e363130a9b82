// Pages that die while they jog, in the time of a simulated board: the axis rests at most 250 ms
// and the time to brake after the last renewal that the server has accepted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <random>
#include <utility>

#include "host/link/simulated_transport.hpp"
#include "host/run/simulated_boards.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/server.hpp"
#include "host/serve/web_server.hpp"
#include "sim/world/world.hpp"
#include "tests/paths.hpp"
#include "tests/scale.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test::dead_page {
namespace {

using namespace std::chrono_literals;
using Ms = std::chrono::milliseconds;

constexpr double lease_and_reaction_ms = 250, acceleration_mm_s2 = 1000;
constexpr ClientNumber page = 1;

/// What becomes of the page.
enum class Death {
  process_killed,  ///< the system closes its connection
  tab_hidden,      ///< it ends the jog
  network_cut,     ///< its connection is closed, which the server notices later
  key_up_lost,     ///< nothing more comes, and the connection stays open
  page_frozen,     ///< SIGSTOP to its computer: the same, and its renewals arrive later
  server_frozen    ///< SIGSTOP to the server: the board gets nothing more
};
constexpr std::array death_names{"process killed", "tab hidden",  "network cut",
                                 "key-up lost",    "page frozen", "server frozen"};
constexpr int deaths = death_names.size();
constexpr double steps_per_mm = 200;
/// Time until a dead page is judged: longer than the lease and the time to brake.
constexpr Ms watched{450};

/// A board in simulated time. Calls `on_time` from the thread of the machine while it waits.
class SimulatedTime final : public link::Transport {
 public:
  SimulatedTime(sim::Board& board, std::function<void(Ms)> on_time)
      : inner_(board), on_time_(std::move(on_time)) {}
  std::size_t write(std::span<const std::uint8_t> bytes) override { return inner_.write(bytes); }
  std::size_t read(std::span<std::uint8_t> bytes) override { return inner_.read(bytes); }
  void wait(std::chrono::microseconds time) override {
    inner_.wait(time);
    on_time_(std::chrono::duration_cast<Ms>(inner_.now()));
  }
  std::chrono::microseconds now() const override { return inner_.now(); }
  bool reconnect() override { return true; }

 private:
  link::SimulatedTransport inner_;
  std::function<void(Ms)> on_time_;
};

/// One page after the other: each takes control, holds a button or moves to a place for a random
/// time, and dies.
class Pages {
 public:
  Pages(const char* board, int first, int kills)
      : made_(run::make_board(board, "", settings_of_test(), sim::WorldConfig{})),
        kill_(first),
        kills_(first + kills) {}

  /// Returns when all pages have died.
  void run() {
    const Now now = [this] {
      return Clock::time_point(std::chrono::microseconds(made_.board->now() / sim::ps_per_us));
    };
    begun_ = now_ms();
    next_ = begun_ + 500ms;  // the machine reads its settings before
    SiteOptions site;
    site.token = token;
    site.now = now;
    const auto folder = std::filesystem::temp_directory_path() / fmt::format("pages-{}", now_us());
    Server server(site, JobFolder(folder));
    WebServer web("127.0.0.1", 0, server);
    {
      Machine machine(
          [this]() -> std::unique_ptr<link::Transport> {
            return std::make_unique<SimulatedTime>(*made_.board, [this](Ms at) { act(at); });
          },
          run::BoardOptions{}, run::MachineOptions{}, now);
      server.use(web, machine);
      server_ = &server;
      machine_ = &machine;
      is_ready_ = true;
      ended_.get_future().wait();
    }
    std::filesystem::remove_all(folder);
  }

  /// From the last renewal to rest, without the time to brake, by way to die.
  const std::array<double, deaths>& worst_ms() const { return worst_ms_; }
  int jogged() const { return jogged_; }

 private:
  static settings::Values settings_of_test() {
    settings::Values values;
    values.set_milli(settings::Id::acceleration_x,
                     static_cast<std::int32_t>(acceleration_mm_s2 * 1000));
    // Places that pages go to are inside of the travel.
    values.set_milli(settings::Id::travel_x, 2'000'000);
    values.set_milli(settings::Id::min_corner_x, -1'000'000);
    return values;
  }

  Ms now_ms() const { return Ms(made_.board->now() / sim::ps_per_ms); }
  std::int32_t x_at(sim::Picoseconds at) const {
    return made_.board->world().drives().position_at(at)[0];
  }
  double last_step_ms() const {
    sim::Picoseconds at = made_.board->now();
    const std::int32_t end = x_at(at);
    while (at > 0 && x_at(at) == end) at -= sim::ps_per_ms;
    EXPECT_GT(at, 0) << "the axis has not moved";
    return static_cast<double>(at / sim::ps_per_ms) + 1;
  }
  std::int64_t server_ms(Ms at) const { return (at - begun_).count(); }

  void request(const char* method, const Json& parameters) {
    const Json text{{"jsonrpc", "2.0"}, {"id", ++id_}, {"method", method}, {"params", parameters}};
    server_->received(page, text.dump());
  }

  void renew(std::int64_t seen) {
    const int direction = begun_at_ > 0 ? -1 : 1;
    if (!goes_)
      request("jog.run", {{"direction", {direction}}, {"feed", feed_}, {"seen", seen}});
    else if (std::exchange(has_begun_, true))
      request("jog.renew", {{"seen", seen}});
    else
      request("jog.go",
              {{"x", begun_at_ / steps_per_mm + 300 * direction}, {"feed", feed_}, {"seen", seen}});
  }

  std::size_t way_to_die() const { return static_cast<std::size_t>(kill_ % deaths); }
  Death death() const { return static_cast<Death>(way_to_die()); }

  /// In the thread of the machine, between two rounds of it.
  void act(Ms at) {
    if (!is_ready_ || kill_ == kills_) return;
    if (is_dead_) return judge_later(at);
    if (at < next_) return;
    if (!is_alive_) return begin();
    if (renewals_left_ == 0) return die(at);
    --renewals_left_;
    next_ = at + 70ms;
    renewed_ = at;
    renew(server_ms(at));
  }

  void begin() {
    if (machine_->view().board.state != "Idle") return;
    is_alive_ = true;
    feed_ = 60.0 * static_cast<double>(20 + random_() % 100);
    renewals_left_ = 3 + static_cast<int>(random_() % 4);
    begun_at_ = x_at(made_.board->now());
    goes_ = random_() % 2 == 0;
    has_begun_ = false;
    server_->opened(page);
    request("login", {{"token", token}, {"client", "client-secret-page"}});
    request("control.take", Json::object());
  }

  void die(Ms at) {
    is_alive_ = false;
    is_dead_ = true;
    died_ = at;
    is_open_ = true;
    closes_at_ = at + (death() == Death::process_killed ? 0ms
                       : death() == Death::network_cut  ? Ms(random_() % 400)
                                                        : watched);
    if (death() == Death::tab_hidden) request("jog.stop", Json::object());
    // No loop of the host runs: simulated time passes inside this call.
    if (death() == Death::server_frozen)
      made_.board->run_until(made_.board->now() + watched.count() * sim::ps_per_ms);
  }

  void judge_later(Ms at) {
    if (is_open_ && at >= closes_at_) {
      is_open_ = false;
      server_->closed(page);
    }
    if (death() == Death::page_frozen && is_open_) return renew(server_ms(renewed_));
    if (at < died_ + watched) return;
    const double brake_ms = feed_ / 60 / acceleration_mm_s2 * 1000;
    const double rest_ms = last_step_ms() - static_cast<double>(renewed_.count());
    EXPECT_LE(rest_ms, lease_and_reaction_ms + brake_ms)
        << "kill " << kill_ << ", " << death_names.at(way_to_die()) << ", " << feed_ << " mm/min, "
        << (goes_ ? "to a place" : "held");
    double& worst_ms = worst_ms_.at(way_to_die());
    worst_ms = std::max(worst_ms, rest_ms - brake_ms);
    if (std::abs(x_at(made_.board->now()) - begun_at_) > 200) ++jogged_;
    is_dead_ = false;
    next_ = at + 60ms;
    if (++kill_ == kills_) ended_.set_value();
  }

  run::SimulatedBoard made_;
  int kill_, kills_;  ///< number of this page; of the last one
  Server* server_ = nullptr;
  Machine* machine_ = nullptr;
  std::atomic<bool> is_ready_{false};
  std::promise<void> ended_;
  // Of the thread of the machine.
  std::mt19937_64 random_{37};
  bool is_alive_ = false, is_dead_ = false, is_open_ = false;
  bool goes_ = false, has_begun_ = false;  ///< to a place; jog.go was sent
  int id_ = 0, renewals_left_ = 0, jogged_ = 0;
  double feed_ = 0;
  std::array<double, deaths> worst_ms_{};
  Ms next_{}, renewed_{}, died_{}, closes_at_{}, begun_{};
  std::int32_t begun_at_ = 0;
};

void kill_pages(const char* board, int kills, Death first = Death::process_killed) {
  Pages pages(board, static_cast<int>(first), kills);
  pages.run();
  EXPECT_EQ(pages.jogged(), kills) << "each page has moved the axis before it died";
  fmt::print("{} pages: at rest at most {:.0f} ms and the time to brake after the last renewal\n",
             kills, *std::ranges::max_element(pages.worst_ms()));
  for (std::size_t i = 0; i < death_names.size(); ++i)
    fmt::print("  {}: {:.0f} ms\n", death_names.at(i), pages.worst_ms().at(i));
}

TEST(DeadPages, end_their_jogs_on_the_virtual_board) {
  kill_pages(run::virtual_board, lamplock::test::scaled(20 * deaths, 20 * deaths));
}

/// A page takes several seconds of the computer here.
TEST(DeadPages, end_their_jogs_on_the_chip) {
  const std::string image = lamplock::test::in_build("lamplock-rp2040.elf");
  if (!std::filesystem::exists(image)) GTEST_SKIP() << "the firmware was not built";
  kill_pages(run::chip_board,
             lamplock::test::is_complete_run() ? 20 * deaths : lamplock::test::scaled(deaths, 2),
             Death::page_frozen);
}

}  // namespace
}  // namespace lamplock::serve::test::dead_page
