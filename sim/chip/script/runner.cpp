#include "sim/chip/script/runner.hpp"

#include <algorithm>
#include <utility>

namespace lamplock::sim::chip::script {
namespace {

std::uint32_t pins_of_all(const Script& script) {
  std::uint32_t pins = 0;
  for (const Step& step : script) pins |= pins_of(step.action);
  return pins;
}

External external(bool level) { return level ? External::high : External::low; }

}  // namespace

Runner::Runner(Chip& chip, SerialPorts& ports, Script script)
    : chip_(chip),
      wheel_(chip.wheel()),
      slot_(wheel_.add(*this)),
      ports_(ports),
      script_(std::move(script)),
      pads_(chip, pins_of_all(script_)),
      time_(moment_of(wheel_, wheel_.now())) {
  for (const Step& step : script_)
    if (const auto* reaction = std::get_if<ExpectReaction>(&step.action))
      causes_.push_back(reaction->cause);
  wheel_.set(slot_, wheel_.now());
}

// First bring everything up to the present: the blocks that are updated in batches, the USB host.
void Runner::run(Cycle /*to*/) {
  if (done_) return;
  const Cycle now = wheel_.now();
  chip_.gpio().catch_up(now);
  ports_.poll(now);
  drive_trains(now);
  poll_beside(now);
  while (!done_ && advance(now)) {
  }
  forget();
  plan();
}

void Runner::plan() { wheel_.set(slot_, done_ ? never_cycle : due(wheel_.now())); }

Cycle Runner::due(Cycle now) const {
  Cycle due = never_cycle;
  if (open_.check) due = open_.check->due(now);
  if (way_) due = cycle_after(wheel_, way_->from, way_->span);
  if (sending_) due = wheel_.cycle_at(wheel_.time_of(now) + poll_interval);
  for (const Open& each : beside_) due = std::min(due, each.check->due(now));
  for (const std::optional<Train>& train : trains_)
    if (train) due = std::min(due, this->due(*train));
  return std::max(due, now + 1);
}

/// Makes one step; false: time has to pass first, or the script is done.
bool Runner::advance(Cycle now) {
  if (open_.check) return poll(open_, now);
  if (way_) return arrive(now);
  if (sending_) return finish_sending(now);
  if (next_ < script_.size() && !std::holds_alternative<End>(script_[next_].action)) {
    ++next_;
    take_step(now);
    return true;
  }
  done_ = beside_.empty();
  return false;
}

bool Runner::arrive(Cycle now) {
  if (now < cycle_after(wheel_, way_->from, way_->span)) return false;
  time_ = after(wheel_, way_->from, way_->span);
  way_.reset();
  return true;
}

bool Runner::finish_sending(Cycle now) {
  ports_.poll(now);
  if (!ports_.ready(*sending_) || !ports_.sent(*sending_)) return false;
  sending_.reset();
  act_now(now);
  return true;
}

/// An action that is late takes place now, and the script's time becomes now.
void Runner::act_now(Cycle now) {
  if (now > time_.cycle) time_ = moment_of(wheel_, now);
}

/// Starts each kind of step.
struct Runner::Actor {
  Runner& runner;
  std::size_t step;
  Cycle now;

  void operator()(const At& what) const {
    if (what.time < runner.time_.time)
      return runner.fail(step, "the script's time is " + time_text(runner.time_.time) + " already",
                         runner.time_.time);
    runner.way_ = Way{{}, {what.time, false}};
  }
  void operator()(const After& what) const { runner.way_ = Way{runner.time_, what.span}; }
  void operator()(const SetPin& what) const {
    runner.act_now(now);
    runner.trains_[what.gpio].reset();
    runner.chip_.gpio().set_external(what.gpio, what.level, now);
  }
  void operator()(const Join& what) const {
    runner.act_now(now);
    runner.chip_.gpio().join(what.one, what.other, now);
  }
  void operator()(const SetVoltage& what) const {
    runner.act_now(now);
    runner.chip_.system().adc.set_input(what.input, what.volts);
  }
  void operator()(const SetTemperature& what) const {
    runner.act_now(now);
    runner.chip_.system().adc.set_temperature(what.celsius);
  }
  void operator()(const Pulse& what) const {
    runner.act_now(now);
    runner.trains_[what.gpio] = Train{what, runner.time_};
    runner.drive_trains(now);
  }
  void operator()(const Send& what) const {
    runner.act_now(now);
    runner.ports_.send(what.port, what.text);
    runner.sending_ = what.port;
  }
  void operator()(const Allow& /*what*/) const {}  // holds for the whole run
  template <class Expectation>
  void operator()(const Expectation& /*what*/) const {
    const Step& here = runner.script_[step];
    Open open{step,
              make_check(here.action, {runner.chip_, runner.pads_, runner.ports_}, runner.time_)};
    if (here.meanwhile)
      runner.beside_.push_back(std::move(open));
    else
      runner.open_ = std::move(open);
  }
};

void Runner::take_step(Cycle now) {
  const std::size_t step = next_ - 1;
  std::visit(Actor{*this, step, now}, script_[step].action);
}

/// Whether the expectation is met; otherwise it is open or the script has failed.
bool Runner::poll(Open& open, Cycle now) {
  const CheckResult result = open.check->poll(now);
  if (result.state == CheckResult::State::open) return false;
  if (result.state == CheckResult::State::failed) {
    fail(open.step, result.seen, result.at.time);
    return false;
  }
  open.check.reset();
  if (&open == &open_) time_ = result.at;
  return true;
}

void Runner::poll_beside(Cycle now) {
  for (Open& each : beside_)
    if (!done_) poll(each, now);
  std::erase_if(beside_, [](const Open& each) { return !each.check; });
}

Cycle Runner::due(const Train& train) const {
  return cycle_after(wheel_, train.begin, train.inside ? train.pulse.width : Span{});
}

void Runner::drive_trains(Cycle now) {
  for (std::optional<Train>& train : trains_) {
    while (train && due(*train) <= now) {
      const Pulse& pulse = train->pulse;
      chip_.gpio().set_external(pulse.gpio, external(pulse.level != train->inside), now);
      train->inside = !train->inside;
      if (train->inside) continue;
      if (++train->sent == pulse.times)
        train.reset();
      else
        train->begin = after(wheel_, train->begin, pulse.period);
    }
  }
}

void Runner::fail(std::size_t step, std::string seen, Picoseconds at) {
  done_ = true;
  failure_ = Failure{script_[step].line, script_[step].text, std::move(seen), at};
}

bool Runner::allows(FaultKind kind) const {
  return std::any_of(script_.begin(), script_.end(), [kind](const Step& step) {
    const Allow* const allow = std::get_if<Allow>(&step.action);
    return allow != nullptr && allow->kind == kind;
  });
}

Failure Runner::not_complete(Picoseconds now) const {
  const std::size_t step = !beside_.empty() && next_ >= script_.size() ? beside_.front().step
                           : next_ > 0                                 ? next_ - 1
                                                                       : 0;
  if (script_.empty()) return {};
  return {script_[step].line, script_[step].text, "not complete yet", now};
}

/// Drops edges that are not needed any more: those before the script's time, before the last cause
/// that a reaction may be expected of, and before what open checks have seen.
void Runner::forget() {
  Cycle needed = time_.cycle;
  if (open_.check) needed = open_.check->needs_from();
  for (const PinEdge& cause : causes_)
    if (const auto last = pads_.last(cause, time_.cycle)) needed = std::min(needed, last->at.cycle);
  for (const Open& each : beside_) needed = std::min(needed, each.check->needs_from());
  pads_.forget_before(needed);
}

}  // namespace lamplock::sim::chip::script
