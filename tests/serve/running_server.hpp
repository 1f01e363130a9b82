// A server with a virtual board in this process, and a record of what it writes to the board.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "host/serve/machine.hpp"
#include "host/serve/server.hpp"
#include "host/serve/web_server.hpp"
#include "tests/serve/raw_client.hpp"

namespace lamplock::serve::test {

inline constexpr const char* token = "0123456789abcdef0123456789abcdef";
inline constexpr const char* pairing_code = "123456";

/// What has been written to the board; read by other threads.
struct Written {
  std::atomic<std::int64_t> bytes{0};
  std::atomic<std::int64_t> line_at_us{0};  ///< wall clock, of the last end of a line; 0: none
  std::atomic<std::int64_t> door_at_us{0};  ///< wall clock, of the last 0x84; 0: none
  std::atomic<bool> is_unplugged{false};
};

struct RunningOptions {
  bool is_simulated = true;  ///< as the server thinks: false, firing needs pairing
  WebLimits limits{};
  std::string password{};
  std::string octoprint_key{};
  std::string camera{};
  std::string left_job{};  ///< file of a server that was killed (running_job.hpp)
};

/// Whether a condition becomes true in 20 s.
template <typename Condition>
bool comes_true(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

class RunningServer {
 public:
  explicit RunningServer(const RunningOptions& options = {});
  ~RunningServer();

  std::uint16_t port() const { return web_->port(); }
  RawClient client(const std::string& name) const {
    return {port(), token, "client-secret-" + name};
  }
  /// A client that has the control.
  RawClient controller() const;
  /// A client that has the control and has started this program.
  RawClient start(const std::string& name, const std::string& text) const;
  Written& written() { return *written_; }
  const Machine& machine() const { return *machine_; }
  const std::filesystem::path& folder() const { return folder_; }
  /// Puts a file into the folder of jobs.
  void add_file(const std::string& name, const std::string& text) const;
  /// Waits until the board has reported a state that begins so; false after 20 s.
  bool wait_for_state(const std::string& state) const;
  /// Waits until the job has ended; its end, empty after 20 s.
  std::string wait_for_end() const;

 private:
  std::filesystem::path folder_;
  std::shared_ptr<Written> written_ = std::make_shared<Written>();
  std::unique_ptr<Server> server_;
  std::unique_ptr<WebServer> web_;
  std::unique_ptr<Machine> machine_;
  std::thread thread_;
};

/// Time of the wall clock that Written has.
std::int64_t now_us();

/// The message of a refused request; empty: it succeeded.
std::string error_of(const nlohmann::json& response);

}  // namespace lamplock::serve::test
