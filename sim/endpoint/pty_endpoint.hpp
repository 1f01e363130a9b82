// A pseudo-terminal: looks like a serial port to the host.
#pragma once

#include <filesystem>
#include <string>

#include "sim/endpoint/byte_endpoint.hpp"

namespace lamplock::sim {

/// Creates a pseudo-terminal in raw mode; the host may open and close it as often as it likes.
class PtyEndpoint : public ByteEndpoint {
 public:
  /// `link`, if not empty, becomes a symbolic link to the terminal (an old link there is replaced,
  /// anything else is not) and is removed at the end. Throws std::system_error.
  explicit PtyEndpoint(std::filesystem::path link = {});
  ~PtyEndpoint() override;
  PtyEndpoint(const PtyEndpoint&) = delete;
  PtyEndpoint& operator=(const PtyEndpoint&) = delete;

  std::size_t read(std::span<std::uint8_t> bytes) override;
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  bool host_present() override;
  std::string address() const override { return link_.empty() ? name_ : link_.string(); }

 private:
  int descriptor_ = -1;
  std::string name_;
  std::filesystem::path link_;
};

}  // namespace lamplock::sim
