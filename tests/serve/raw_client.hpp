// A client of the server by plain sockets, which can do what a browser does not: wrong headers,
// halves of requests, no reading.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace lamplock::serve::test {

using Json = nlohmann::json;

/// A TCP connection to this computer.
class RawSocket {
 public:
  /// `source`: the last byte of its own address, 127.0.0.source.
  explicit RawSocket(std::uint16_t port, std::uint8_t source = 1);
  ~RawSocket();
  RawSocket(RawSocket&& other) noexcept;
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  /// False if the other side has closed.
  bool send(std::string_view bytes);
  /// What has come; waits at most this time for the first byte. Empty: nothing, or closed.
  std::string read(std::chrono::milliseconds wait);
  /// All bytes until the other side closes, or this time has passed.
  std::string read_all(std::chrono::milliseconds wait);
  bool is_closed() const { return is_closed_; }
  void close();

 private:
  int descriptor_;
  bool is_closed_ = false;
};

/// The reply to one request; the status is the first number of it, 0 without a reply.
struct Reply {
  int status = 0;
  std::string text;
};
Reply request(std::uint16_t port, const std::string& bytes, std::uint8_t source = 1);

/// A WebSocket of JSON-RPC.
class RawClient {
 public:
  RawClient(std::uint16_t port, std::string token, std::string secret);

  /// Sends a request and returns the response to it; notifications before it are kept.
  Json call(const std::string& method, const Json& parameters = Json::object());
  /// Sends a request without waiting; returns its id.
  int send(const std::string& method, const Json& parameters = Json::object());
  void send_text(const std::string& text);
  /// The next message, from what has come already or comes in this time; nothing otherwise.
  std::optional<Json> receive(std::chrono::milliseconds wait);
  /// The status with all notifications so far.
  const Json& status() const { return status_; }
  std::int64_t time() const { return time_; }
  /// Receives for this time.
  void watch(std::chrono::milliseconds time);
  /// The last binary message.
  std::string take_bytes() { return std::exchange(bytes_, {}); }
  RawSocket& socket() { return socket_; }

 private:
  void send_frame(std::uint8_t opcode, std::string_view payload);
  std::optional<std::string> take_frame();

  RawSocket socket_;
  std::string received_, bytes_;
  Json status_;
  std::int64_t time_ = 0;
  int last_id_ = 0;
};

}  // namespace lamplock::serve::test
