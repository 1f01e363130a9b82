#include "host/serve/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/serve/error_message.hpp"
#include "host/serve/jpeg_stream.hpp"

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;
using boost::system::error_code;

/// Pause after a picture of a file or of an address of single pictures (pages ask four times a
/// second), and after a problem.
constexpr auto picture_interval = 200ms, retry_interval = 1000ms;
/// A camera that sends nothing for this time does not answer. Streams have a picture each second at
/// least.
constexpr auto network_time = 3s;
/// How soon a wait ends with the server.
constexpr auto end_check_interval = 100ms;
constexpr std::string_view scheme = "http://";

/// Pages do not ask for pictures any more, or the server ends.
struct NotWanted {};

bool is_port(std::string_view text) {
  unsigned port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc() && end == text.data() + text.size() && port > 0 && port <= 65535;
}

}  // namespace

/// One request to a camera of the network. Connecting, writing and reading have a time limit;
/// resolving a name has that of the system.
class Camera::Connection {
 public:
  /// Throws Error(no_device), or NotWanted, as read() does.
  Connection(const Address& address, const Camera& camera) : camera_(camera) {
    error_code error;
    const auto places = asio::ip::tcp::resolver(io_).resolve(address.host, address.port, error);
    if (error) fail(error);
    wait_for([&](auto done) {
      asio::async_connect(socket_, places, [done](const error_code& e, const auto&) { done(e); });
    });
    const std::string request =
        fmt::format("GET {} HTTP/1.0\r\nHost: {}\r\nConnection: close\r\n\r\n", address.path,
                    address.authority);
    wait_for([&](auto done) {
      asio::async_write(socket_, asio::buffer(request),
                        [done](const error_code& e, std::size_t) { done(e); });
    });
  }

  /// Empty at the end of the response.
  std::string_view read() {
    std::size_t count = 0;
    wait_for([&](auto done) {
      socket_.async_read_some(asio::buffer(bytes_), [&, done](const error_code& e, std::size_t n) {
        count = n;
        done(e == asio::error::eof ? error_code() : e);
      });
    });
    return {bytes_.data(), count};
  }

 private:
  [[noreturn]] static void fail(const error_code& error) {
    throw Error(Exit::no_device, "camera", error.message(), "check its address and its cable");
  }

  /// Begins an operation and waits for its end, the time limit, or the end of the camera.
  template <class Begin>
  void wait_for(Begin begin) {
    bool is_done = false;
    error_code result;
    begin([&](const error_code& error) {
      is_done = true;
      result = error;
    });
    const auto until = Clock::now() + network_time;
    io_.restart();
    while (!is_done && Clock::now() < until && camera_.is_wanted()) io_.run_for(end_check_interval);
    if (!is_done) {
      error_code ignored;
      socket_.close(ignored);
      io_.restart();
      io_.run();  // the operation ends before its variables
      if (!camera_.is_wanted()) throw NotWanted();
      throw Error(Exit::no_device, "camera", "does not answer", "check its address and its cable");
    }
    if (result) fail(result);
  }

  const Camera& camera_;
  asio::io_context io_;
  asio::ip::tcp::socket socket_{io_};
  std::array<char, 64 * 1024> bytes_{};
};

/// "http://HOST[:PORT][/PATH]" (RFC 3986, section 3); addresses of IPv6 are in square brackets.
std::optional<Camera::Address> Camera::address_of(const std::string& source) {
  if (!source.starts_with(scheme) || source.find_first_of(" \r\n\t@") != std::string::npos)
    return std::nullopt;
  const std::size_t path = std::min(source.find('/', scheme.size()), source.size());
  Address address;
  address.authority = source.substr(scheme.size(), path - scheme.size());
  address.path = path == source.size() ? "/" : source.substr(path);
  std::string_view rest = address.authority;
  if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    address.host = rest.substr(1, end - 1);
    rest.remove_prefix(end + 1);
  } else {
    address.host = rest.substr(0, rest.find(':'));
    rest.remove_prefix(address.host.size());
  }
  if (!rest.empty() && rest.front() != ':') return std::nullopt;
  address.port = rest.empty() ? "80" : rest.substr(1);
  if (address.host.empty() || !is_port(address.port)) return std::nullopt;
  return address;
}

Camera::Camera(const std::string& source, std::chrono::milliseconds ask_time)
    : ask_time_(ask_time) {
  if (source.find("://") == std::string::npos) {
    file_ = source;
  } else {
    const auto address = address_of(source);
    if (!address)
      throw Error(Exit::bad_input, "--camera", fmt::format("'{}' is not an http address", source),
                  "give one such as http://192.168.1.9:8080/stream, or a file");
    address_ = *address;
  }
  thread_ = std::thread([this] { run(); });
}

Camera::~Camera() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::shared_ptr<const std::string> Camera::picture() {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (wanted_until_ <= now) {
    problem_.clear();  // of an earlier time
    changed_.notify_all();
  }
  wanted_until_ = now + ask_time_;
  return picture_ && now - taken_at_ <= max_age ? picture_ : nullptr;
}

std::string Camera::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

bool Camera::is_wanted() const {
  const std::lock_guard lock(mutex_);
  return !ending_ && wanted_until_ > Clock::now();
}

void Camera::run() {
  while (true) {
    auto pause = std::chrono::milliseconds(picture_interval);
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ending_ || wanted_until_ > Clock::now(); });
      if (ending_) return;
    }
    try {
      if (file_.empty())
        read_network();
      else
        read_file_once();
    } catch (const NotWanted&) {
      continue;
    } catch (const std::exception& error) {
      pause = retry_interval;
      const std::lock_guard lock(mutex_);
      problem_ = message_of(error);
    }
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, pause, [this] { return ending_; });
  }
}

/// The file may be incomplete while another program writes it; the next reading finds it complete.
void Camera::read_file_once() {
  std::error_code error;
  // Devices and pipes may have no end. A file that does not exist gets its reason by read_file().
  if (std::filesystem::exists(file_, error) && !std::filesystem::is_regular_file(file_, error))
    throw Error(Exit::bad_input, file_, "is not a regular file",
                "give a JPEG file, or the address of a program that serves the device, for example "
                "ustreamer");
  const auto size = std::filesystem::file_size(file_, error);
  if (!error && size > max_picture_bytes)
    throw Error(Exit::bad_input, file_,
                fmt::format("is larger than {} MiB", max_picture_bytes / (1024 * 1024)),
                "write smaller pictures");
  std::string picture = read_file(file_);
  if (!is_jpeg(picture))
    throw Error(Exit::bad_input, file_, "is not a complete JPEG picture",
                "write a JPEG file under another name, and rename it when it is complete");
  keep(std::move(picture));
}

void Camera::read_network() {
  Connection connection(address_, *this);
  JpegStream stream;
  bool has_picture = false;
  const auto keep_one = [&](std::string&& picture) {
    keep(std::move(picture));
    has_picture = true;
  };
  while (is_wanted() && !stream.is_over()) {
    const std::string_view bytes = connection.read();
    for (std::string& picture : stream.take(bytes)) keep_one(std::move(picture));
    if (!bytes.empty()) continue;
    if (auto last = stream.close()) keep_one(std::move(*last));
    if (!has_picture)
      throw Error(Exit::no_device, "camera", "closes the connection before a picture is complete",
                  "check its address");
  }
}

void Camera::keep(std::string picture) {
  const std::lock_guard lock(mutex_);
  picture_ = std::make_shared<const std::string>(std::move(picture));
  taken_at_ = Clock::now();
  problem_.clear();
}

}  // namespace lamplock::serve
