#include "host/run/point_job_control.hpp"

#include <algorithm>

#include "host/job/job.hpp"
#include "host/link/sender.hpp"
#include "host/text.hpp"

namespace lamplock::run {
namespace {

constexpr std::uint32_t job_speed_step = 10;  ///< percent

}  // namespace

std::vector<std::size_t> pauses_of(const job::Job& job) {
  std::vector<std::size_t> pauses;
  for (std::size_t i = 0; i < job.targets.size(); ++i)
    if (job.is_pause(i)) pauses.push_back(i);
  return pauses;
}

std::size_t PointJobControl::pauses_before(std::size_t target) const {
  return static_cast<std::size_t>(std::lower_bound(pauses_.begin(), pauses_.end(), target) -
                                  pauses_.begin());
}

void PointJobControl::update_progress() {
  const std::size_t next = sender_.points_fired();
  progress_.update(next - pauses_before(next));
}

std::string PointJobControl::keys() const {
  return "keys: ! holds, Enter resumes, Ctrl-C twice stops; + - or 80 and Enter: job speed";
}

ProgressState PointJobControl::state() const {
  ProgressState shown;
  const wire::MachineState machine = sender_.job_status().state;
  if (sender_.is_cut())
    shown.word = "no link";
  else if (stopping_)
    shown.word = "stopping";
  else if (machine == wire::MachineState::door)
    shown.word = "door open";
  else if (machine == wire::MachineState::hold)
    shown.word = held_word;
  else if (holding_)
    shown.word = "holding";
  else if (std::binary_search(pauses_.begin(), pauses_.end(), sender_.points_fired()))
    shown.word = pause_word;
  else if (machine == wire::MachineState::run && !sender_.job_status().lamp_locked &&
           sender_.job().keeps_to_lamp())
    shown.word = "no lamp";
  if (sender_.job_speed() != wire::full_job_speed)
    shown.speed = "speed " + std::to_string(sender_.job_speed()) + " %";
  return shown;
}

void PointJobControl::take_interrupts(int count) {
  if (count >= interrupts_to_stop()) return stop();
  if (count > 0 && !holding_) hold();
}

void PointJobControl::hold() {
  holding_ = true;
  sender_.pause();
  note("holding");
}

void PointJobControl::watch_machine() {
  if (sender_.is_cut() && !is_cut_)
    note(
        "the board does not answer: trying to connect again; look at the machine, it may still "
        "fire");
  else if (!sender_.is_cut() && is_cut_)
    note("connected again");
  is_cut_ = sender_.is_cut();
  const wire::MachineState state = sender_.status().state;
  if (state == wire::MachineState::door && !asking_)
    ask("door open, laser off: close it");
  else if (state == wire::MachineState::hold && holding_ && !asking_)
    ask("held, laser off");
  ask_about_hold();
}

/// A hold that neither the user nor this program has requested.
void PointJobControl::ask_about_hold() {
  const wire::Status& status = sender_.status();
  const bool is_held = status.state == wire::MachineState::hold;
  const wire::HoldReason reason = is_held ? status.hold_reason : wire::HoldReason::none;
  const bool is_new = reason != asked_about_;
  asked_about_ = reason;
  // A button at the machine, or another program, may have resumed.
  if (asking_ && !holding_ && status.state == wire::MachineState::run) asking_ = false;
  if (!is_new || asking_) return;
  if (reason == wire::HoldReason::not_made) ask("shot not made, held, laser off");
  if (reason == wire::HoldReason::lamp) ask("lamp does not answer its trigger, held, laser off");
  if (reason == wire::HoldReason::sensor) ask("temperature sensor out of range, held, laser off");
  if (reason == wire::HoldReason::realtime && !sender_.auto_resume())
    ask("held by a hold byte ('!' or 0x84) that another program or a person sent, laser off");
}

void PointJobControl::ask(const std::string& why) {
  asking_ = true;
  // The advice where to continue follows the stop: points that the last status did not count may
  // have been fired since.
  ask_user(why, held_by_key_ ? "Enter to resume, Ctrl-C to stop"
                             : "Enter to resume, Ctrl-C again to stop");
}

void PointJobControl::take_word(const std::string& word) {
  if (word.front() == '!') {
    held_by_key_ = held_by_key_ || !holding_;
    if (!holding_) return hold();
    return note("held; Enter resumes");
  }
  const std::uint32_t present = sender_.job_speed();
  const auto percent = number_of<std::uint32_t>(word.substr(0, word.find_last_not_of(" \t%") + 1));
  if (word == "+")
    change_job_speed(present + job_speed_step);
  else if (word == "-")
    change_job_speed(present > job_speed_step ? present - job_speed_step : 1);
  else if (word == "=")
    change_job_speed(wire::full_job_speed);
  else if (percent && *percent > 0)
    change_job_speed(*percent);
  else
    note(
        "! holds, Enter alone resumes; a job speed in percent, + or - and Enter changes the speed");
}

void PointJobControl::change_job_speed(std::uint32_t percent) {
  percent = std::min(percent, wire::max_job_speed);
  sender_.set_job_speed(percent);
  note("job speed " + std::to_string(percent) + " %");
}

void PointJobControl::resume_machine() {
  interrupts_->forget();
  asking_ = held_by_key_ = false;
  sender_.resume();
}

void PointJobControl::hold_for_obstacle(bool) { sender_.pause(); }

void PointJobControl::end_machine(bool) { sender_.stop(); }

void PointJobControl::take_end_of_input() {
  note("no terminal input to resume the job");
  stop();
}

void PointJobControl::stop() {
  stopping_ = true;
  sender_.stop();
  note(sender_.is_cut()
           ? "stopping: without a connection the stop does not reach the board; press the "
             "emergency stop of the machine"
           : "stopping");
}

}  // namespace lamplock::run
