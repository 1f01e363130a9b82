#include "host/serve/logins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/serve/access.hpp"
#include "host/serve/client_json.hpp"
#include "host/serve/hashes.hpp"

namespace lamplock::serve {
namespace {

constexpr std::chrono::hours session_time{12};  ///< after its last use
constexpr std::size_t max_sessions = 100;

WebReply refused(int status, const char* text) {
  return {status, "text/plain; charset=utf-8", std::string(text) + "\n"};
}

}  // namespace

bool LoginLimit::allows(const std::string& address, Clock::time_point now) {
  while (!failures_.empty() && now - failures_.front().at >= window) failures_.pop_front();
  const auto of_one =
      std::count_if(failures_.begin(), failures_.end(),
                    [&](const Failure& failure) { return failure.address == address; });
  return failures_.size() < max_of_all && static_cast<std::size_t>(of_one) < max_of_one;
}

void LoginLimit::add_failure(const std::string& address, Clock::time_point now) {
  failures_.push_back({address, now});
}

bool Logins::is_session(std::string_view token) {
  const auto now = now_();
  std::erase_if(sessions_, [now](const auto& each) { return now - each.second > session_time; });
  for (auto& [known, used_at] : sessions_) {
    if (!is_same_secret(known, token)) continue;
    used_at = now;
    return true;
  }
  return false;
}

void Logins::request(const std::string& body, const std::string& address, Answer answer) {
  const auto request = client_json(body);
  const auto password = request.is_object() ? request.find("password") : request.end();
  if (!request.is_object() || password == request.end() || !password->is_string())
    return answer(refused(400, "needs a JSON object with a password"));
  if (!limit_.allows(address, now_()))
    return answer(refused(429, "too many wrong passwords; wait for 5 minutes"));
  if (asked_) return answer(refused(503, "another password is checked now; try again"));
  asked_ = Asked{address, std::move(answer)};
  check_.start([hash = hash_, given = password->get<std::string>()] {
    return given.size() <= max_password && is_password(hash, given);
  });
}

void Logins::poll() {
  if (!asked_) return;
  const std::optional<bool> is_right = check_.take();
  if (!is_right) return;
  const Asked asked = *std::exchange(asked_, std::nullopt);
  note_(fmt::format("{} from {}", *is_right ? "login" : "wrong password", asked.address));
  if (*is_right) return open_session(asked.answer);
  limit_.add_failure(asked.address, now_());
  asked.answer(refused(401, "the password is wrong"));
}

void Logins::open_session(const Answer& answer) {
  if (sessions_.size() >= max_sessions)
    sessions_.erase(std::min_element(sessions_.begin(), sessions_.end(),
                                     [](auto& a, auto& b) { return a.second < b.second; }));
  const std::string token = random_token();
  sessions_[token] = now_();
  answer({200, "application/json", nlohmann::json{{"token", token}}.dump()});
}

}  // namespace lamplock::serve
