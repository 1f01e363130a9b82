#include "host/serve/page_frontend.hpp"

#include <sstream>
#include <thread>
#include <utility>

namespace lamplock::serve {
namespace {

/// A stop of a client is never a pause (frontend.hpp).
constexpr int stop_count = 2;
constexpr std::size_t max_words = 100;

/// Machine and work coordinates move together.
void move_to(BoardView& board, const std::vector<double>& place) {
  if (place.empty()) return;
  const std::vector<double> before = std::exchange(board.machine_mm, place);
  if (before.size() != place.size() || board.work_mm.size() != place.size()) return;
  for (std::size_t a = 0; a < place.size(); ++a) board.work_mm[a] += place[a] - before[a];
}

class PageProgress final : public run::Progress {
 public:
  PageProgress(const JobScreen& screen, const std::string& title, std::size_t total,
               std::size_t first)
      : screen_(screen) {
    screen_.change([&](BoardView&, JobView& job) {
      job.title = title;
      job.total = total;
      job.done = first;
    });
  }
  void update(std::size_t done) override {
    if (done == done_) return;
    done_ = done;
    screen_.change([done](BoardView&, JobView& job) { job.done = done; });
  }
  void set_left(std::optional<double> seconds) override {
    screen_.change([&](BoardView&, JobView& job) { job.left_s = seconds; });
  }
  void set_state(const run::ProgressState& state) override {
    screen_.change([&](BoardView& board, JobView& job) {
      job.word = state.word;
      job.speed = state.speed;
      move_to(board, state.place);
    });
  }
  void note(const std::string& line) override { screen_.show_line(line); }

 private:
  const JobScreen& screen_;
  std::size_t done_ = ~std::size_t{0};
};

class PageInterrupts final : public run::Interrupts {
 public:
  explicit PageInterrupts(const JobRequests& requests) : requests_(requests) {}
  int count() const override { return requests_.is_stopping() ? stop_count : 0; }
  void forget() override {}

 private:
  const JobRequests& requests_;
};

class PageInput final : public run::LineInput {
 public:
  explicit PageInput(JobRequests& requests) : requests_(requests) {}
  std::vector<std::string> lines(std::chrono::milliseconds wait) override {
    auto words = requests_.take_words();
    if (words.empty() && wait.count() > 0) std::this_thread::sleep_for(wait);
    return words;
  }
  void read_ahead() override {}
  bool ended() const override { return false; }
  bool is_typed() const override { return true; }
  bool needs_keys_shown() const override { return false; }
  std::string begun() const override { return ""; }

 private:
  JobRequests& requests_;
};

}  // namespace

void JobRequests::stop() {
  const std::lock_guard lock(mutex_);
  is_stopping_ = true;
}

bool JobRequests::type(std::string word) {
  const std::lock_guard lock(mutex_);
  if (words_.size() == max_words) return false;
  words_.push_back(std::move(word));
  return true;
}

bool JobRequests::is_stopping() const {
  const std::lock_guard lock(mutex_);
  return is_stopping_;
}

std::vector<std::string> JobRequests::take_words() {
  const std::lock_guard lock(mutex_);
  return std::exchange(words_, {});
}

void PageFrontend::text(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) screen_.show_line(line);
}

void PageFrontend::phase(const std::string& name, const std::string& what) {
  screen_.show_line(name + ": " + what);
}

std::unique_ptr<run::Progress> PageFrontend::progress(std::string title, std::size_t total,
                                                      std::size_t first) {
  return std::make_unique<PageProgress>(screen_, title, total, first);
}

std::unique_ptr<run::Interrupts> PageFrontend::interrupts() {
  return std::make_unique<PageInterrupts>(requests_);
}

std::unique_ptr<run::LineInput> PageFrontend::line_input() {
  return std::make_unique<PageInput>(requests_);
}

}  // namespace lamplock::serve
