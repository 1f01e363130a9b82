#include "host/pendant/display_writer.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace lamplock::pendant {

struct DisplayWriter::Shared {
  std::unique_ptr<HidDevice> device;  ///< used by the thread only
  std::mutex mutex{};
  std::condition_variable changed{};
  std::vector<FeatureReport> next{};
  bool writing = false, ended = false;

  void write_until_ended() {
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [this] { return ended || !next.empty(); });
      if (ended) return;
      const std::vector<FeatureReport> reports = std::exchange(next, {});
      writing = true;
      lock.unlock();
      for (const FeatureReport& report : reports) device->send_feature(report);
      lock.lock();
      writing = false;
    }
  }
};

DisplayWriter::DisplayWriter(std::unique_ptr<HidDevice> device)
    : shared_(std::make_shared<Shared>()) {
  shared_->device = std::move(device);
  // Detached: a device that hangs may delay the end of the thread.
  std::thread([shared = shared_] { shared->write_until_ended(); }).detach();
}

DisplayWriter::~DisplayWriter() {
  const std::lock_guard lock(shared_->mutex);
  shared_->ended = true;
  shared_->changed.notify_one();
}

void DisplayWriter::write(std::vector<FeatureReport> reports) {
  const std::lock_guard lock(shared_->mutex);
  shared_->next = std::move(reports);
  shared_->changed.notify_one();
}

bool DisplayWriter::idle() const {
  const std::lock_guard lock(shared_->mutex);
  return !shared_->writing && shared_->next.empty();
}

}  // namespace lamplock::pendant
