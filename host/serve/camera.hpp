// The camera over the machine: its newest picture.
//
// In:  a source of JPEG pictures: an address of the network (one picture or an MJPEG stream), or a
//      file that another program writes. Out: the newest picture. Who: the server, for pages.
//
// The source is read in a thread of the camera while pages ask for pictures, and not otherwise.
// Pages know neither the address nor anything of it: the server reads it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace lamplock::serve {

class Camera {
 public:
  /// `source`: "http://HOST[:PORT]/PATH", or a file. Throws Error(bad_input) for another address.
  explicit Camera(const std::string& source);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// A picture of at most max_age, or null; the source is read for ask_time from now on. Returns at
  /// once.
  std::shared_ptr<const std::string> picture();
  /// Why there is none; empty: none has come yet.
  std::string problem() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Address {
    std::string host, port, path;
  };
  class Connection;

  void run();
  bool is_wanted() const;
  void read_file_once();
  void read_network();
  void keep(std::string picture);

  static constexpr std::chrono::seconds max_age{5}, ask_time{5};

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
