#include "tests/serve/running_server.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <future>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/link/line_port.hpp"
#include "host/serve/hashes.hpp"
#include "host/serve/lent_transport.hpp"
#include "host/serve/paced_transport.hpp"
#include "sim/world/world.hpp"

namespace lamplock::serve::test {
namespace {

using namespace std::chrono_literals;

/// The cable: counts and times what passes, and can be unplugged.
class Cable final : public link::Transport {
 public:
  Cable(std::shared_ptr<PacedTransport> board, std::shared_ptr<Written> written)
      : board_(std::move(board)), written_(std::move(written)) {}
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (!connected()) return 0;
    const std::size_t count = board_->write(bytes);
    written_->bytes += static_cast<std::int64_t>(count);
    const auto sent = bytes.first(count);
    if (std::find(sent.begin(), sent.end(), '\n') != sent.end()) written_->line_at_us = now_us();
    if (std::find(sent.begin(), sent.end(), link::realtime::door) != sent.end())
      written_->door_at_us = now_us();
    return count;
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    return connected() ? board_->read(bytes) : 0;
  }
  void wait(std::chrono::microseconds time) override { board_->wait(time); }
  std::chrono::microseconds now() const override { return board_->now(); }
  bool connected() const override { return !written_->is_unplugged; }
  bool reconnect() override { return connected() && board_->reconnect(); }

 private:
  std::shared_ptr<PacedTransport> board_;
  std::shared_ptr<Written> written_;
};

settings::Values laser_machine() {
  settings::Values values;
  values.set_milli(settings::Id::laser_mode, 1000);
  return values;
}

}  // namespace

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::string error_of(const nlohmann::json& response) {
  return response.contains("error") ? response["error"]["message"].get<std::string>() : "";
}

RunningServer::RunningServer(const RunningOptions& options)
    : folder_(std::filesystem::temp_directory_path() /
              fmt::format("lamplock-serve-{}-{}", getpid(), now_us())) {
  SiteOptions site;
  site.board = "virtual";
  site.is_simulated = options.is_simulated;
  site.token = token;
  site.code = pairing_code;
  site.library = (folder_ / "library.db").string();
  site.octoprint_key = options.octoprint_key;
  site.camera = options.camera;
  if (!options.password.empty()) site.password_hash = password_hash(options.password);
  const JobFolder folder(folder_);
  if (!options.left_job.empty()) write_file(folder_ / ".running.json", options.left_job);
  server_ = std::make_unique<Server>(site, folder);
  web_ = std::make_unique<WebServer>("127.0.0.1", 0, *server_, options.limits);
  const auto board = std::make_shared<PacedTransport>(
      run::make_board(run::virtual_board, "", laser_machine(), sim::WorldConfig{}));
  const auto open = [board, written = written_]() -> std::unique_ptr<link::Transport> {
    if (written->is_unplugged)
      throw Error(Exit::no_device, "virtual", "is unplugged", "plug it in");
    return std::make_unique<Cable>(board, written);
  };
  machine_ = std::make_unique<Machine>(open, run::BoardOptions{}, run::MachineOptions{});
  server_->use(*web_, *machine_);
  thread_ = std::thread([this] { web_->run(20ms, [this] { server_->tick(); }); });
  wait_for_state("Idle");
  std::promise<void> rested;  // the machine knows its limits then
  machine_->post([](link::LinePort&) {}, [&](const std::exception_ptr&) { rested.set_value(); });
  rested.get_future().wait();
}

RunningServer::~RunningServer() {
  web_->stop();
  thread_.join();
  machine_->end();
  server_->end();
  machine_.reset();
  web_.reset();
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void RunningServer::add_file(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name) << text;
}

RawClient RunningServer::controller() const {
  RawClient client = this->client("client");
  client.call("control.take");
  return client;
}

RawClient RunningServer::start(const std::string& name, const std::string& text) const {
  add_file(name, text);
  RawClient client = controller();
  client.call("job.start", {{"name", name}});
  return client;
}

bool RunningServer::wait_for_state(const std::string& state) const {
  return comes_true([&] { return machine_->view().board.state.starts_with(state); });
}

std::string RunningServer::wait_for_end() const {
  return comes_true([&] { return !machine_->view().job.is_running; }) ? machine_->view().job.end
                                                                      : "";
}

}  // namespace lamplock::serve::test
