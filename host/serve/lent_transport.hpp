// A connection that a use case borrows: it may end its use, but does not close it.
//
// In:  the connection of the server. Out: the same, as the use case owns it. Who: the machine.
#pragma once

#include "host/link/transport.hpp"

namespace lamplock::serve {

/// `lender` must outlive it.
class LentTransport final : public link::Transport {
 public:
  explicit LentTransport(link::Transport& lender) : lender_(lender) { set_board(lender.board()); }
  std::size_t write(std::span<const std::uint8_t> bytes) override { return lender_.write(bytes); }
  std::size_t read(std::span<std::uint8_t> bytes) override { return lender_.read(bytes); }
  void wait(std::chrono::microseconds time) override { lender_.wait(time); }
  std::chrono::microseconds now() const override { return lender_.now(); }
  bool connected() const override { return lender_.connected(); }
  bool reconnect() override { return lender_.reconnect(); }

 private:
  link::Transport& lender_;
};

}  // namespace lamplock::serve
