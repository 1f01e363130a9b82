// The camera over the machine: its newest picture.
//
// In:  a source of JPEG pictures: an address of the network (one picture or an MJPEG stream), or a
//      file that another program writes. Out: the newest picture. Who: the server, for pages.
//
// A thread of the camera reads the source while pages ask for pictures, and not otherwise. Only the
// server reads the source; it does not send its address to pages.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace lamplock::serve {

/// Keeps the newest picture of one source.
class Camera {
 public:
  /// `source`: "http://HOST[:PORT]/PATH", or a file. `ask_time`: how long the source is read after
  /// a page has asked. Throws Error(bad_input) for another address.
  explicit Camera(const std::string& source, std::chrono::milliseconds ask_time = default_ask_time);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// The newest picture, or null if there is none or the source sent it more than max_age ago. The
  /// source is read for ask_time from now on. Does not wait.
  std::shared_ptr<const std::string> picture();
  /// Why the last attempt to get a picture has failed; empty: none has failed since pages ask.
  std::string problem() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Address {
    std::string authority, host, port, path;  ///< host without square brackets
  };
  class Connection;

  static std::optional<Address> address_of(const std::string& source);
  void run();
  bool is_wanted() const;
  void read_file_once();
  void read_network();
  void keep(std::string picture);

  /// An older picture could be taken for what the machine does now.
  static constexpr std::chrono::seconds max_age{5};
  /// Longer than the pause of a page after a problem (page/camera.js), so that one connection
  /// serves all pictures.
  static constexpr std::chrono::seconds default_ask_time{5};

  const std::chrono::milliseconds ask_time_;
  std::string file_;  ///< empty: address_
  Address address_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const std::string> picture_;
  Clock::time_point taken_at_{}, wanted_until_{};
  std::string problem_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace lamplock::serve
