// Logins with the password: sessions, and a limit of wrong passwords.
//
// In:  requests to log in, with the address of their computer. Out: a token for each session, which
//      is used as the token of the server is.
// Who: the server. The hash is computed in a thread of its own, so that nothing waits for it; one
//      at a time, so that requests cannot occupy the computer.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "host/run/background.hpp"
#include "host/serve/clock.hpp"
#include "host/serve/note.hpp"
#include "host/serve/web_server.hpp"

namespace lamplock::serve {

/// Wrong passwords in a time, of one computer and of all.
class LoginLimit {
 public:
  static constexpr std::chrono::minutes window{5};
  static constexpr std::size_t max_of_one = 5, max_of_all = 50;

  bool allows(const std::string& address, Clock::time_point now);
  void add_failure(const std::string& address, Clock::time_point now);

 private:
  struct Failure {
    std::string address;
    Clock::time_point at;
  };
  std::deque<Failure> failures_;  ///< oldest first
};

class Logins {
 public:
  /// `hash` of the password; empty: there are no logins.
  Logins(std::string hash, Now now, Note note)
      : hash_(std::move(hash)), now_(std::move(now)), note_(std::move(note)) {}

  bool has_password() const { return !hash_.empty(); }
  /// Whether a session has this token; it is used now.
  bool is_session(std::string_view token);
  /// `body` is {"password": text}. The answer is {"token": text}, or a refusal.
  void request(const std::string& body, const std::string& address, Answer answer);
  /// To be called regularly: answers.
  void poll();
  /// Drops a request that is not answered.
  void end() { asked_.reset(); }

 private:
  struct Asked {
    std::string address;
    Answer answer;
  };
  void open_session(const Answer& answer);

  std::string hash_;
  Now now_;
  Note note_;
  std::map<std::string, Clock::time_point, std::less<>> sessions_;  ///< token, last use
  LoginLimit limit_;
  run::Background<bool> check_;
  std::optional<Asked> asked_;
};

}  // namespace lamplock::serve
