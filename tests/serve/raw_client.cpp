#include "tests/serve/raw_client.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace lamplock::serve::test {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

RawSocket::RawSocket(std::uint16_t port, std::uint8_t source)
    : descriptor_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + source);
  if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("no such address");
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("no server");
}

RawSocket::RawSocket(RawSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), is_closed_(other.is_closed_) {}

RawSocket::~RawSocket() { close(); }

void RawSocket::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  is_closed_ = true;
}

bool RawSocket::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

std::string RawSocket::read(std::chrono::milliseconds wait) {
  if (is_closed_) return "";
  pollfd ready{descriptor_, POLLIN, 0};
  if (::poll(&ready, 1, static_cast<int>(wait.count())) <= 0) return "";
  std::array<char, 65536> bytes{};
  const ssize_t count = ::recv(descriptor_, bytes.data(), bytes.size(), 0);
  if (count <= 0) {
    is_closed_ = true;
    return "";
  }
  return {bytes.data(), static_cast<std::size_t>(count)};
}

std::string RawSocket::read_all(std::chrono::milliseconds wait) {
  std::string all;
  for (const auto until = Clock::now() + wait; !is_closed_ && Clock::now() < until;)
    all += read(20ms);
  return all;
}

Reply request(std::uint16_t port, const std::string& bytes, std::uint8_t source) {
  RawSocket socket(port, source);
  socket.send(bytes);
  Reply reply;
  reply.text = socket.read_all(5s);
  if (reply.text.starts_with("HTTP/1.1 ")) reply.status = std::stoi(reply.text.substr(9, 3));
  return reply;
}

RawClient::RawClient(std::uint16_t port, std::string its_token, std::string secret)
    : socket_(port) {
  socket_.send(
      fmt::format("GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\n"
                  "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                  "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n",
                  port));
  const std::string end = "\r\n\r\n";
  for (const auto until = Clock::now() + 5s; Clock::now() < until && !socket_.is_closed();) {
    received_ += socket_.read(100ms);
    if (received_.find(end) != std::string::npos) break;
  }
  received_.erase(0, received_.find(end) + end.size());
  call("login", {{"token", std::move(its_token)}, {"client", std::move(secret)}, {"name", "test"}});
}

int RawClient::send(const std::string& method, const Json& parameters) {
  send_text(Json{{"jsonrpc", "2.0"}, {"id", ++last_id_}, {"method", method}, {"params", parameters}}
                .dump());
  return last_id_;
}

void RawClient::send_text(const std::string& text) { send_frame(1, text); }

Json RawClient::call(const std::string& method, const Json& parameters) {
  const int id = send(method, parameters);
  for (const auto until = Clock::now() + 10s; Clock::now() < until && !socket_.is_closed();)
    if (const auto message = receive(100ms); message && message->value("id", Json()) == id) {
      if (method == "subscribe") status_ = message->at("result");
      return *message;
    }
  return nullptr;
}

std::optional<Json> RawClient::receive(std::chrono::milliseconds wait) {
  const auto until = Clock::now() + wait;
  for (bool was_read = false;; was_read = true) {
    while (const auto text = take_frame()) {
      Json message = Json::parse(*text);
      if (message.value("method", "") == "status") {
        time_ = message["params"]["time"];
        status_.merge_patch(message["params"]["patch"]);
      }
      return message;
    }
    const auto left =
        std::max(0ms, std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()));
    if ((was_read && left == 0ms) || socket_.is_closed()) return std::nullopt;
    received_ += socket_.read(left);
  }
}

void RawClient::watch(std::chrono::milliseconds time) {
  const auto until = Clock::now() + time;
  while (Clock::now() < until && !socket_.is_closed())
    receive(std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()) + 1ms);
}

/// The mask is zero, so that the payload is sent as it is.
void RawClient::send_frame(std::uint8_t opcode, std::string_view payload) {
  std::string frame{static_cast<char>(0x80 | opcode)};
  const auto byte = [&](std::size_t value) { frame += static_cast<char>(value & 0xFF); };
  if (payload.size() < 126) {
    byte(0x80 | payload.size());
  } else if (payload.size() < 65536) {
    byte(0x80 | 126);
    for (int shift = 8; shift >= 0; shift -= 8) byte(payload.size() >> shift);
  } else {
    byte(0x80 | 127);
    for (int shift = 56; shift >= 0; shift -= 8) byte(payload.size() >> shift);
  }
  frame += std::string(4, '\0');
  socket_.send(frame + std::string(payload));
}

std::optional<std::string> RawClient::take_frame() {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(received_[i]); };
  if (received_.size() < 2) return std::nullopt;
  std::size_t length = byte(1) & 0x7F, head = 2;
  if (length >= 126) {
    head = length == 126 ? 4 : 10;
    if (received_.size() < head) return std::nullopt;
    length = 0;
    for (std::size_t i = 2; i < head; ++i) length = length << 8 | byte(i);
  }
  if (received_.size() < head + length) return std::nullopt;
  const int opcode = byte(0) & 0x0F;
  const std::string payload = received_.substr(head, length);
  received_.erase(0, head + length);
  if (opcode == 1) return payload;
  if (opcode == 2) bytes_ = payload;
  if (opcode == 9) send_frame(10, payload);
  if (opcode == 8) socket_.close();
  return take_frame();
}

}  // namespace lamplock::serve::test
