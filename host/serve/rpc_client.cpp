#include "host/serve/rpc_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host/error.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;
namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::seconds max_wait{5};
constexpr const char* remedy = "give the address that lamplock serve prints";

[[noreturn]] void refuse(const std::string& text, const char* what) {
  throw Error(Exit::bad_input, text.empty() ? "page" : text.substr(0, text.find('#')), what,
              remedy);
}

/// The reply to a request, whole: the server closes the connection after it.
std::string reply_to(const PageAddress& address, const std::string& request) {
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  std::string reply;
  const auto read = [&](const error_code& error, std::size_t) {
    if (!error)
      asio::async_read(socket, asio::dynamic_buffer(reply), [](const error_code&, std::size_t) {});
  };
  const auto write = [&](const error_code& error, const asio::ip::tcp::endpoint&) {
    if (!error) asio::async_write(socket, asio::buffer(request), read);
  };
  error_code unknown;
  const auto places = asio::ip::tcp::resolver(io).resolve(address.host, address.port, unknown);
  if (!unknown) asio::async_connect(socket, places, write);
  io.run_for(max_wait);
  if (reply.empty())
    throw Error(Exit::no_device, fmt::format("{}:{}", address.host, address.port),
                "no server answers", "start lamplock serve, and give the address that it prints");
  return reply;
}

}  // namespace

PageAddress parse_page_address(const std::string& text) {
  constexpr std::string_view scheme = "http://", mark = "/#token=";
  if (text.starts_with("https://"))
    refuse(text, "is encrypted, which this command does not support");
  const std::size_t end = text.find(mark);
  if (!text.starts_with(scheme) || end == std::string::npos)
    refuse(text, "is not the address of a page with its token");
  const std::string authority = text.substr(scheme.size(), end - scheme.size());
  const std::size_t colon = authority.rfind(':');
  if (colon == std::string::npos) refuse(text, "has no port");
  PageAddress address{authority.substr(0, colon), authority.substr(colon + 1),
                      text.substr(end + mark.size())};
  if (address.host.size() > 2 && address.host.front() == '[')  // of IPv6
    address.host = address.host.substr(1, address.host.size() - 2);
  const auto is_plain = [](const std::string& part, std::string_view allowed) {
    return !part.empty() && part.find_first_not_of(allowed) == std::string::npos;
  };
  constexpr std::string_view hex = "0123456789abcdef";
  if (!is_plain(address.port, "0123456789") || !is_plain(address.token, hex) ||
      !is_plain(address.host, "abcdefghijklmnopqrstuvwxyz0123456789.:-"))
    refuse(text, "is not the address of a page with its token");
  return address;
}

Json RpcClient::call(const std::string& method, const Json& parameters) {
  const std::string host =
      address_.host.find(':') == std::string::npos ? address_.host : "[" + address_.host + "]";
  const std::string body = Json{
      {"jsonrpc", "2.0"},
      {"id", ++last_id_},
      {"method", method},
      {"params", parameters}}.dump();
  const std::string reply = reply_to(
      address_, fmt::format("POST /api HTTP/1.1\r\nHost: {}:{}\r\nAuthorization: Bearer {}\r\n"
                            "Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{}",
                            host, address_.port, address_.token, body.size(), body));
  const std::size_t head_end = std::min(reply.find("\r\n\r\n"), reply.size());
  if (!reply.starts_with("HTTP/1.1 200")) {
    const bool is_token = reply.starts_with("HTTP/1.1 401");
    throw Error(Exit::no_device, fmt::format("{}:{}", host, address_.port),
                is_token ? "the token is wrong: the server has been started again"
                         : "is not a server of lamplock",
                remedy);
  }
  const Json answer =
      Json::parse(reply.substr(std::min(head_end + 4, reply.size())), nullptr, false);
  if (answer.is_object() && answer.contains("error"))
    throw Error(Exit::job_failed, method,
                answer.value("/error/message"_json_pointer, std::string("has failed")),
                "see docs/api.md");
  if (!answer.is_object() || !answer.contains("result"))
    throw Error(Exit::no_device, fmt::format("{}:{}", host, address_.port),
                "sent a reply that is cut off", "try again");
  return answer["result"];
}

}  // namespace lamplock::serve
