#include "host/serve/web_server.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <limits>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/serve/content_policy.hpp"

namespace lamplock::serve {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// A frozen computer is noticed after this time; half of it later the client is asked.
constexpr std::chrono::seconds idle_time{20};

std::string address_of(const tcp::endpoint& end) {
  const asio::ip::address address = end.address();
  // A socket of both families shows an address of IPv4 inside one of IPv6.
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
  return address.to_string();
}

/// `name`: of http::field, or a text.
template <class Fields, class Name>
std::optional<std::string> only_field(const Fields& fields, Name name) {
  const auto count = fields.count(name);
  if (count == 0) return std::nullopt;
  const auto value = fields[name];
  return count == 1 ? std::string(value.data(), value.size()) : std::string();
}

/// The bytes are no HTTP; not that the connection has ended.
bool is_malformed(const error_code& error) {
  return error.category() == http::make_error_code(http::error::end_of_stream).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

template <class Body>
WebRequest request_of(const http::request<Body>& message) {
  WebRequest request;
  const auto text = [](beast::string_view view) { return std::string(view.data(), view.size()); };
  request.method = text(message.method_string());
  request.target = text(message.target());
  request.host = only_field(message, http::field::host).value_or("");
  request.origin = only_field(message, http::field::origin);
  request.content_type = only_field(message, http::field::content_type).value_or("");
  request.authorization = only_field(message, http::field::authorization).value_or("");
  request.api_key = only_field(message, beast::string_view("X-Api-Key")).value_or("");
  request.is_upgrade = websocket::is_upgrade(message);
  return request;
}

}  // namespace

struct WebServer::Parts {
  class Socket;
  class Exchange;
  class Place;

  Parts(WebSite& its_site, WebLimits its_limits) : site(its_site), limits(its_limits) {}

  void accept();
  void send(ClientNumber client, std::string content, bool is_text);

  WebSite& site;
  WebLimits limits;
  std::size_t connections = 0;
  std::map<asio::ip::address, std::size_t> by_address;  ///< of `connections`
  ClientNumber last_client = 0;
  std::map<ClientNumber, std::shared_ptr<Socket>> sockets;
  // The context ends before the others: its handlers own connections, which use them.
  asio::io_context io;
  tcp::acceptor acceptor{io};
};

/// A connection as far as it counts for the limits.
class WebServer::Parts::Place {
 public:
  Place(Parts& parts, asio::ip::address address) : parts_(parts), address_(std::move(address)) {
    ++parts_.connections;
    ++parts_.by_address[address_];
  }
  ~Place() {
    --parts_.connections;
    if (--parts_.by_address[address_] == 0) parts_.by_address.erase(address_);
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  static bool has_room(const Parts& parts, const asio::ip::address& address) {
    const auto known = parts.by_address.find(address);
    return parts.connections < parts.limits.connections &&
           (known == parts.by_address.end() || known->second < parts.limits.connections_of_address);
  }

 private:
  Parts& parts_;
  asio::ip::address address_;
};

/// One WebSocket.
class WebServer::Parts::Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(Parts& parts, std::unique_ptr<Place> place, tcp::socket socket)
      : parts_(parts),
        place_(std::move(place)),
        number_(++parts.last_client),
        stream_(std::move(socket)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void begin(const http::request<http::string_body>& upgrade) {
    beast::get_lowest_layer(stream_).expires_never();
    websocket::stream_base::timeout times{};
    times.handshake_timeout = parts_.limits.header_time;
    times.idle_timeout = idle_time;
    times.keep_alive_pings = true;
    stream_.set_option(times);
    stream_.auto_fragment(false);
    stream_.read_message_max(parts_.limits.message_bytes);
    stream_.async_accept(upgrade, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->parts_.sockets[self->number_] = self;
      self->parts_.site.opened(self->number_);
      self->read();
    });
  }

  void send(std::string content, bool is_text) {
    if (queued_bytes_ + content.size() > parts_.limits.queue_bytes) return drop();
    queued_bytes_ += content.size();
    queue_.push_back({std::move(content), is_text});
    if (queue_.size() == 1) write();
  }

  bool is_behind() const { return !queue_.empty(); }
  bool is_stuck(Clock::time_point now) const {
    return is_behind() && now - written_at_ > parts_.limits.message_time;
  }

  void drop() {
    if (parts_.sockets.erase(number_) == 0) return;
    error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
    parts_.site.closed(number_);
  }

 private:
  struct Message {
    std::string content;
    bool is_text;
  };

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->drop();
      const std::string text = beast::buffers_to_string(self->buffer_.data());
      self->buffer_.consume(self->buffer_.size());
      self->parts_.site.received(self->number_, text);
      if (self->parts_.sockets.count(self->number_) != 0) self->read();
    });
  }

  void write() {
    written_at_ = Clock::now();
    stream_.text(queue_.front().is_text);
    stream_.async_write(asio::buffer(queue_.front().content),
                        [self = shared_from_this()](error_code error, std::size_t) {
                          if (error) return self->drop();
                          self->queued_bytes_ -= self->queue_.front().content.size();
                          self->queue_.pop_front();
                          if (!self->queue_.empty()) self->write();
                        });
  }

  Parts& parts_;
  std::unique_ptr<Place> place_;
  ClientNumber number_;
  websocket::stream<beast::tcp_stream, false> stream_;  // without compression
  beast::flat_buffer buffer_;
  std::deque<Message> queue_;
  std::size_t queued_bytes_ = 0;
  Clock::time_point written_at_{};
};

/// One request of HTTP and its reply, after which the connection is closed.
class WebServer::Parts::Exchange : public std::enable_shared_from_this<Exchange> {
 public:
  Exchange(Parts& parts, std::unique_ptr<Place> place, tcp::socket socket)
      : parts_(parts), place_(std::move(place)), stream_(std::move(socket)) {
    parser_.header_limit(static_cast<std::uint32_t>(parts_.limits.header_bytes));
    parser_.body_limit(std::numeric_limits<std::uint64_t>::max());  // set after the header, before
                                                                    // any of the body is read
  }
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  void begin() {
    stream_.expires_after(parts_.limits.header_time);
    http::async_read_header(stream_, buffer_, parser_,
                            [self = shared_from_this()](error_code error, std::size_t) {
                              if (!error) return self->take_header();
                              if (error == http::error::header_limit)
                                return self->answer({431, "text/plain", "header is too long"});
                              if (is_malformed(error))
                                self->answer({400, "text/plain", "is no HTTP request"});
                            });
  }

 private:
  void take_header() {
    const WebRequest head = own_request();
    const Admission admission = parts_.site.admit(head);
    if (admission.refusal) return answer(*admission.refusal);
    if (head.is_upgrade) {
      // Bytes that came after the header before the reply would be lost.
      if (buffer_.size() != 0) return answer({400, "text/plain", "data before the upgrade"});
      const auto socket =
          std::make_shared<Socket>(parts_, std::move(place_), stream_.release_socket());
      return socket->begin(parser_.get());
    }
    const auto length = parser_.content_length();
    if (length && *length > admission.max_body)
      return answer({413, "text/plain", fmt::format("at most {} bytes", admission.max_body)});
    parser_.body_limit(admission.max_body);
    stream_.expires_after(parts_.limits.body_time);
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](error_code error, std::size_t) {
                       if (error == http::error::body_limit)
                         return self->answer({413, "text/plain", "body is too long"});
                       if (!error) self->take_body();
                     });
  }

  WebRequest own_request() {
    WebRequest request = request_of(parser_.get());
    error_code ignored;
    request.local = address_of(stream_.socket().local_endpoint(ignored));
    request.remote = address_of(stream_.socket().remote_endpoint(ignored));
    return request;
  }

  void take_body() {
    stream_.expires_never();  // the machine may need its time
    WebRequest request = own_request();
    request.body = std::move(parser_.get().body());
    parts_.site.reply(std::move(request), [self = shared_from_this()](WebReply reply) {
      self->answer(std::move(reply));
    });
  }

  void answer(WebReply reply) {
    reply_ = {};
    reply_.result(static_cast<unsigned>(reply.status));
    reply_.set(http::field::content_type, reply.type);
    reply_.set("Content-Security-Policy", reply.policy.empty() ? page_policy() : reply.policy);
    reply_.set("X-Content-Type-Options", "nosniff");
    reply_.set("Cross-Origin-Resource-Policy", "same-origin");
    reply_.set("Referrer-Policy", "no-referrer");
    reply_.set(http::field::cache_control, "no-store");
    reply_.keep_alive(false);
    reply_.body() = std::move(reply.body);
    reply_.prepare_payload();
    stream_.expires_after(parts_.limits.reply_time);
    http::async_write(stream_, reply_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Parts& parts_;
  std::unique_ptr<Place> place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{16 * 1024};
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> reply_;
};

void WebServer::Parts::accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    const auto address =
        socket.is_open() ? socket.remote_endpoint(error).address() : asio::ip::address();
    if (!error && Place::has_room(*this, address)) {
      socket.set_option(tcp::no_delay(true), error);
      std::make_shared<Exchange>(*this, std::make_unique<Place>(*this, address), std::move(socket))
          ->begin();
    }
    accept();
  });
}

WebServer::WebServer(const std::string& address, std::uint16_t port, WebSite& site,
                     WebLimits limits)
    : parts_(std::make_shared<Parts>(site, limits)) {
  error_code error;
  const auto host = asio::ip::make_address(address, error);
  if (error)
    throw Error(Exit::bad_input, address, "is not an address", "give one such as 127.0.0.1");
  const tcp::endpoint endpoint(host, port);
  tcp::acceptor& acceptor = parts_->acceptor;
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw Error(Exit::no_device, fmt::format("{}:{}", address, port),
                "cannot listen: " + error.message(),
                "end the other server, or give another port with --port");
  parts_->accept();
}

WebServer::~WebServer() {
  // Handlers that the context still has refer to the parts.
  parts_->sockets.clear();
}

std::uint16_t WebServer::port() const { return parts_->acceptor.local_endpoint().port(); }

void WebServer::run(std::chrono::milliseconds interval, const std::function<void()>& tick) {
  asio::steady_timer timer(parts_->io);
  std::function<void(error_code)> on_time = [&](error_code error) {
    if (error) return;
    std::vector<std::shared_ptr<Parts::Socket>> stuck;
    for (const auto& [number, socket] : parts_->sockets)
      if (socket->is_stuck(Clock::now())) stuck.push_back(socket);
    for (const auto& socket : stuck) socket->drop();
    tick();
    timer.expires_after(interval);
    timer.async_wait(on_time);
  };
  timer.expires_after(interval);
  timer.async_wait(on_time);
  parts_->io.run();
}

void WebServer::post(std::function<void()> work) { asio::post(parts_->io, std::move(work)); }

void WebServer::stop() { parts_->io.stop(); }

void WebServer::Parts::send(ClientNumber client, std::string content, bool is_text) {
  const auto found = sockets.find(client);
  if (found == sockets.end()) return;
  const std::shared_ptr<Socket> socket = found->second;  // send() may drop it
  socket->send(std::move(content), is_text);
}

void WebServer::send(ClientNumber client, std::string text) {
  parts_->send(client, std::move(text), true);
}

void WebServer::send_bytes(ClientNumber client, std::string bytes) {
  parts_->send(client, std::move(bytes), false);
}

bool WebServer::is_behind(ClientNumber client) const {
  const auto found = parts_->sockets.find(client);
  return found != parts_->sockets.end() && found->second->is_behind();
}

void WebServer::drop(ClientNumber client) {
  const auto found = parts_->sockets.find(client);
  if (found == parts_->sockets.end()) return;
  const std::shared_ptr<Parts::Socket> socket = found->second;
  socket->drop();
}

}  // namespace lamplock::serve
