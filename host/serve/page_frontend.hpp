// The clients of the server as the frontend of a use case that runs a job.
//
// In:  requests of clients (hold, resume, stop, speed), from any thread. Out: what the use case
//      shows, as the view of the job and lines of the console.
// Who: the machine, for the time of one job. A request takes effect at the next step of the sender.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "host/run/frontend.hpp"
#include "host/serve/machine_view.hpp"

namespace lamplock::serve {

/// Requests of clients to the running job.
class JobRequests {
 public:
  void stop();
  /// A word that a user of a terminal would type: "!", "", "+", "80". False if too many words wait.
  bool type(std::string word);

  bool is_stopping() const;
  std::vector<std::string> take_words();

 private:
  mutable std::mutex mutex_;
  bool is_stopping_ = false;
  std::vector<std::string> words_;
};

/// Where a use case shows what it does. The functions lock what they need.
struct JobScreen {
  std::function<void(const std::string&)> show_line;
  /// Changes the view of the job.
  std::function<void(const std::function<void(BoardView&, JobView&)>&)> change;
};

/// `requests` must outlive it.
class PageFrontend final : public run::Frontend {
 public:
  PageFrontend(JobRequests& requests, JobScreen screen)
      : requests_(requests), screen_(std::move(screen)) {}

  void line(const std::string& text) override { screen_.show_line(text); }
  void text(const std::string& text) override;
  void notice(const std::string& text) override { screen_.show_line(text); }
  void phase(const std::string& name, const std::string& what) override;
  void restart_clock() override {}
  std::unique_ptr<run::Progress> progress(std::string title, std::size_t total,
                                          std::size_t first) override;
  std::unique_ptr<run::Interrupts> interrupts() override;
  std::unique_ptr<run::LineInput> line_input() override;
  std::unique_ptr<run::LineInput> dialogue_input() override { return line_input(); }
  /// The server has the permission before the job begins.
  bool can_ask() const override { return true; }
  bool confirms(const std::string&) override { return false; }

 private:
  JobRequests& requests_;
  JobScreen screen_;
};

}  // namespace lamplock::serve
