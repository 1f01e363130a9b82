#include "host/link/job_inquiry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <variant>

#include "host/error.hpp"
#include "host/link/continuation.hpp"
#include "host/link/not_stopped.hpp"

namespace lamplock::link {
namespace {

using Time = std::chrono::microseconds;

constexpr Time answer_timeout{3'000'000};  ///< until an answer
constexpr Time ask_again{250'000};         ///< until a question or its answer counts as lost
constexpr Time inquiry_interval{5'000};    ///< between two reads
constexpr Time stop_timeout{10'000'000};   ///< for the board to come to rest
constexpr std::uint32_t no_session = 0;

}  // namespace

JobInquiry::JobInquiry(Transport& transport)
    : transport_(transport), connection_(transport), tag_(std::random_device()()) {}

wire::Status JobInquiry::end_job(std::span<const std::uint32_t> sessions) {
  const Time deadline = transport_.now() + stop_timeout;
  std::uint32_t number = 0;  // of the command: the board executes it once
  for (;;) {
    const wire::Status status = ask();
    const bool is_ours =
        std::find(sessions.begin(), sessions.end(), status.session) != sessions.end();
    if (!is_ours || is_at_rest(status.state)) return status;
    if (number == 0) number = status.last_command + 1;
    if (status.last_command >= number && transport_.now() < deadline) continue;
    if (transport_.now() >= deadline)
      throw NotStopped(Exit::job_failed, "machine",
                       "could not be stopped, it may still move and fire",
                       "press its emergency stop or switch it off");
    const std::array payload{static_cast<std::uint8_t>(wire::Command::stop)};
    connection_.send({wire::FrameType::command, status.session, number}, payload);
  }
}

wire::Status JobInquiry::ask() {
  const Time deadline = transport_.now() + answer_timeout;
  while (transport_.now() < deadline) {
    const bool cut = !transport_.connected() && !connection_.reconnect();
    if (!cut) connection_.send_query(no_session, ++tag_);
    if (const auto status = wait_for_answer(transport_.now() + ask_again)) return *status;
  }
  throw Error(Exit::no_device, "machine", "does not answer",
              "check port, power and firmware, and that no other program uses the machine");
}

std::optional<wire::Status> JobInquiry::wait_for_answer(Time until) {
  while (transport_.now() < until) {
    connection_.flush();
    if (const auto status = receive()) return status;
    transport_.wait(inquiry_interval);
  }
  return std::nullopt;
}

/// The answer to the last question, if received.
std::optional<wire::Status> JobInquiry::receive() {
  while (const auto message = connection_.receive()) {
    if (const auto* text = std::get_if<std::string>(&*message))
      if (const auto mark = parse_restart_mark(*text)) mark_ = mark;
    const auto* status = std::get_if<wire::Status>(&*message);
    if (status == nullptr) continue;
    if (status->version != wire::protocol_version)
      throw Error(Exit::no_device, "machine",
                  fmt::format("its firmware has protocol version {}, this program version {}",
                              status->version, wire::protocol_version),
                  "install the firmware and the program of the same release");
    if (status->echo == tag_) return *status;
  }
  return std::nullopt;
}

}  // namespace lamplock::link
