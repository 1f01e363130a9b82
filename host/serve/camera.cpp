#include "host/serve/camera.hpp"

#include <fmt/format.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
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

/// Between two pictures of a file or of an address of single pictures, and after a problem.
constexpr auto picture_interval = 200ms, retry_interval = 1000ms;
constexpr auto network_time = 3s;
constexpr auto end_check_interval = 100ms;
constexpr std::string_view scheme = "http://";

}  // namespace

/// One request to a camera of the network, with a limit for each wait.
class Camera::Connection {
 public:
  Connection(const Address& address, const Camera& camera) : camera_(camera) {
    error_code error;
    const auto places = asio::ip::tcp::resolver(io_).resolve(address.host, address.port, error);
    if (!error)
      wait_for([&](auto done) {
        asio::async_connect(socket_, places, [done](const error_code& e, const auto&) { done(e); });
      });
    const std::string request = fmt::format(
        "GET {} HTTP/1.0\r\nHost: {}\r\nConnection: close\r\n\r\n", address.path, address.host);
    if (error) fail(error);
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
      throw Error(Exit::no_device, "camera", "does not answer", "check its address and its cable");
    }
    if (result) fail(result);
  }

  const Camera& camera_;
  asio::io_context io_;
  asio::ip::tcp::socket socket_{io_};
  std::array<char, 64 * 1024> bytes_{};
};

Camera::Camera(const std::string& source) {
  if (source.find("://") == std::string::npos) {
    file_ = source;
  } else {
    const std::size_t path = source.find('/', scheme.size());
    std::string authority = source.substr(0, path);
    if (!source.starts_with(scheme) || authority.size() <= scheme.size() ||
        source.find_first_of(" \r\n\t@") != std::string::npos)
      throw Error(Exit::bad_input, "--camera", source + " is not an address of http",
                  "give one such as http://192.168.1.9:8080/stream, or a file");
    authority.erase(0, scheme.size());
    const std::size_t colon = authority.rfind(':');
    const bool has_port = colon != std::string::npos && authority.back() != ']';
    address_.host = authority.substr(0, has_port ? colon : std::string::npos);
    address_.port = has_port ? authority.substr(colon + 1) : "80";
    address_.path = path == std::string::npos ? "/" : source.substr(path);
    if (address_.host.size() > 2 && address_.host.front() == '[')  // of IPv6
      address_.host = address_.host.substr(1, address_.host.size() - 2);
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
  if (wanted_until_ <= now) changed_.notify_all();
  wanted_until_ = now + ask_time;
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
    } catch (const std::exception& error) {
      pause = retry_interval;
      const std::lock_guard lock(mutex_);
      problem_ = message_of(error);
    }
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, pause, [this] { return ending_; });
  }
}

/// The program that writes the file may be in the middle of it: the next reading has it whole.
void Camera::read_file_once() {
  std::error_code error;
  const auto size = std::filesystem::file_size(file_, error);
  if (!error && size > max_picture_bytes)
    throw Error(Exit::bad_input, file_, "is larger than a picture may be", "write a smaller one");
  std::string picture = read_file(file_);
  if (!is_jpeg(picture))
    throw Error(Exit::bad_input, file_, "is no whole JPEG picture", "write one");
  keep(std::move(picture));
}

void Camera::read_network() {
  Connection connection(address_, *this);
  JpegStream stream;
  while (is_wanted()) {
    const std::string_view bytes = connection.read();
    if (bytes.empty()) {
      if (auto last = stream.close()) keep(std::move(*last));
      return;
    }
    for (std::string& picture : stream.take(bytes)) keep(std::move(picture));
  }
}

void Camera::keep(std::string picture) {
  const std::lock_guard lock(mutex_);
  picture_ = std::make_shared<const std::string>(std::move(picture));
  taken_at_ = Clock::now();
  problem_.clear();
}

}  // namespace lamplock::serve
