#include "tests/usb/cabled_board.hpp"

#include <algorithm>
#include <array>

namespace lamplock::usb::test {
namespace {

using std::chrono::microseconds;
using Clock = std::chrono::steady_clock;

/// Polling interval of the host controller.
constexpr microseconds slice{500};
/// A computer that is busy for longer than this also stops the board's time.
constexpr microseconds max_slice{5'000};
constexpr std::size_t piece_size = 512;

}  // namespace

CabledBoard::CabledBoard(sim::Board& board, EmulatedUsb& usb)
    : board_(board), usb_(usb), info_(emulated_board()), thread_([this] { serve(); }) {}

CabledBoard::~CabledBoard() { ended_ = true; }

void CabledBoard::end() {
  ended_ = true;
  if (thread_.joinable()) thread_.join();
}

void CabledBoard::plug(const std::string& place) {
  info_.place = place;
  ++info_.address;
  BulkDevice& device = devices_.emplace_back();
  usb_.attach(info_, device);
  usb_.add(info_);
  usb_.set_node(info_, device.node());
  const std::lock_guard lock(mutex_);
  device_ = &device;
}

void CabledBoard::unplug(int status) {
  const std::lock_guard lock(mutex_);
  device_->unplug(status);
  device_ = nullptr;
  usb_.remove(info_);
  to_board_.clear();
  to_host_.clear();
  board_.reconnect();
}

void CabledBoard::fail(int status) {
  const std::lock_guard lock(mutex_);
  device_->fail(status);
}

void CabledBoard::ignore_cable(std::chrono::milliseconds time) {
  const std::lock_guard lock(mutex_);
  ignores_until_ = Clock::now() + time;
}

void CabledBoard::serve() {
  Clock::time_point last = Clock::now();
  while (!ended_) {
    std::this_thread::sleep_for(slice);
    const Clock::time_point now = Clock::now();
    const auto passed = std::chrono::duration_cast<microseconds>(now - last);
    last = now;
    const std::lock_guard lock(mutex_);
    move_bytes();
    board_.run_until(board_.now() + std::min(passed, max_slice).count() * sim::ps_per_us);
  }
}

void CabledBoard::move_bytes() {
  if (device_ == nullptr || Clock::now() < ignores_until_) return;
  std::array<std::uint8_t, piece_size> piece{};
  const auto begin = piece.begin();
  for (bool more = true; more;) {
    if (to_board_.empty())
      to_board_.assign(begin, begin + static_cast<std::ptrdiff_t>(device_->take(piece)));
    const std::size_t taken = board_.write(to_board_);
    to_board_.erase(to_board_.begin(), to_board_.begin() + static_cast<std::ptrdiff_t>(taken));
    more = taken > 0;
  }
  for (bool more = true; more;) {
    if (to_host_.empty())
      to_host_.assign(begin, begin + static_cast<std::ptrdiff_t>(board_.read(piece)));
    const std::size_t given = device_->give(to_host_);
    to_host_.erase(to_host_.begin(), to_host_.begin() + static_cast<std::ptrdiff_t>(given));
    more = given > 0;
  }
}

}  // namespace lamplock::usb::test
