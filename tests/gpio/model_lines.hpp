// A model of chips and their lines: pins that a test drives, outputs that it reads, chips that it
// unplugs, and edges, which not every chip reports.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/gpio/lines.hpp"

namespace lamplock::test {

/// Pins by the place in a request, with the levels at the pin: true is high.
class ModelPins {
 public:
  struct Pin {
    bool level = false;
    bool requested = false, plugged = true;
    bool has_edges = true;  ///< false: a chip without interrupts
    gpio::LineRequest request{};
    unsigned edges = 0;  ///< since the last poll
  };

  /// Drives an input.
  void set(const std::string& place, bool level) {
    Pin& pin = pins[place];
    if (pin.level == level) return;
    pin.level = level;
    if (pin.requested && pin.has_edges) ++pin.edges;
  }
  void unplug(const std::string& place) { pins[place].plugged = false; }
  bool level(const std::string& place) { return pins[place].level; }
  bool requested(const std::string& place) { return pins[place].requested; }

  std::map<std::string, Pin> pins{};
  /// Called on each change of an output's level.
  std::function<void(const std::string& place, bool level)> on_output{};
};

/// Lines connected to the pins of a test.
class ModelLines final : public gpio::Lines {
 public:
  explicit ModelLines(std::shared_ptr<ModelPins> pins) : pins_(std::move(pins)) {}

  std::vector<gpio::ChipInfo> chips() override { return {}; }

  std::unique_ptr<gpio::Input> input(const gpio::LineRequest& wanted) override {
    take(wanted);
    return std::make_unique<In>(pins_, wanted);
  }
  std::unique_ptr<gpio::Output> output(const gpio::LineRequest& wanted, bool active) override {
    take(wanted);
    auto made = std::make_unique<Out>(pins_, wanted);
    made->set(active);
    return made;
  }

 private:
  class In final : public gpio::Input {
   public:
    In(std::shared_ptr<ModelPins> pins, gpio::LineRequest request)
        : pins_(std::move(pins)), request_(std::move(request)) {}
    ~In() override { pins_->pins[request_.place].requested = false; }
    bool moved() override {
      ModelPins::Pin& pin = pins_->pins[request_.place];
      if (!pin.plugged) return false;
      return std::exchange(pin.edges, 0u) > 0;
    }
    std::optional<bool> active() override {
      const ModelPins::Pin& pin = pins_->pins[request_.place];
      if (!pin.plugged) return std::nullopt;
      return pin.level != request_.active_low;
    }

   private:
    std::shared_ptr<ModelPins> pins_;
    gpio::LineRequest request_;
  };

  class Out final : public gpio::Output {
   public:
    Out(std::shared_ptr<ModelPins> pins, gpio::LineRequest request)
        : pins_(std::move(pins)), request_(std::move(request)) {}
    ~Out() override { pins_->pins[request_.place].requested = false; }
    bool set(bool active) override {
      ModelPins::Pin& pin = pins_->pins[request_.place];
      if (!pin.plugged) return false;
      const bool level = active != request_.active_low;
      const bool changes = pin.level != level;
      pin.level = level;
      if (changes && pins_->on_output) pins_->on_output(request_.place, level);
      return true;
    }

   private:
    std::shared_ptr<ModelPins> pins_;
    gpio::LineRequest request_;
  };

  void take(const gpio::LineRequest& wanted) {
    ModelPins::Pin& pin = pins_->pins[wanted.place];
    if (pin.requested || !pin.plugged)
      throw Error(Exit::no_device, wanted.place, "cannot be had", "see the model");
    pin.requested = true;
    pin.request = wanted;
  }

  std::shared_ptr<ModelPins> pins_;
};

}  // namespace lamplock::test
