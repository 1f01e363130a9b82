// HTTP and WebSocket on one address: connections, limits, time limits, queues.
//
// In:  an address, a site that answers. Out: requests and messages for the site, its replies.
// Who: `serve`. The functions of a site are called in the thread of run(); only post() and stop()
//      may be called by other threads. No function waits for a client: a client that does not read
//      its messages is dropped.
// This header has nothing of Boost: web_server.cpp is the one file that compiles Beast.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace lamplock::serve {

/// A request, whose body may not have been read yet. A header that was sent several times is empty:
/// two readers could take different ones.
struct WebRequest {
  std::string method, target, host, content_type, authorization, api_key;
  std::string local, remote;  ///< addresses of the two ends: "127.0.0.1"
  std::optional<std::string> origin{};
  bool is_upgrade = false;  ///< to a WebSocket
  std::string body{};
};

struct WebReply {
  int status = 200;
  std::string type = "text/plain; charset=utf-8", body{};
  std::string policy{};  ///< Content-Security-Policy; empty: page_policy()
};

/// Sends the reply of a request; to be called once, in the thread of the server.
using Answer = std::function<void(WebReply)>;

/// What is allowed to a request whose header was read.
struct Admission {
  std::optional<WebReply> refusal{};
  std::size_t max_body = 0;  ///< bytes
};

/// Number of a WebSocket, never used again.
using ClientNumber = std::uint64_t;

class WebSite {
 public:
  virtual ~WebSite() = default;
  /// Called before the body is read, and before the upgrade to a WebSocket.
  virtual Admission admit(const WebRequest& head) = 0;
  virtual void reply(WebRequest request, Answer answer) = 0;
  virtual void opened(ClientNumber client) = 0;
  virtual void received(ClientNumber client, const std::string& text) = 0;
  virtual void closed(ClientNumber client) = 0;
};

struct WebLimits {
  std::size_t connections = 512, connections_of_address = 256;
  std::size_t header_bytes = 8192, message_bytes = 256 * 1024;
  std::size_t queue_bytes = 1024 * 1024;  ///< of messages that wait for one client
  std::chrono::milliseconds header_time{10'000}, body_time{60'000}, reply_time{10'000};
  std::chrono::milliseconds message_time{5'000};  ///< until a client has taken a message
};

class WebServer {
 public:
  /// Listens; port 0: any free port. Throws Error: bad_input (no such address), no_device (the port
  /// is in use).
  WebServer(const std::string& address, std::uint16_t port, WebSite& site, WebLimits limits = {});
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;
  /// Serves until stop(); calls `tick` at this interval.
  void run(std::chrono::milliseconds interval, const std::function<void()>& tick);
  /// Queues a function for the thread of run().
  void post(std::function<void()> work);
  void stop();

  /// Queues a message; the client is dropped if its queue is full.
  void send(ClientNumber client, std::string text);
  /// The same as a binary message.
  void send_bytes(ClientNumber client, std::string bytes);
  /// Messages for this client wait.
  bool is_behind(ClientNumber client) const;
  void drop(ClientNumber client);

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;
};

}  // namespace lamplock::serve
