// A simulated board of any kind with the world on its pins.
//
// In:  bytes of the host; time, as far as the owner of the board lets it pass.
// Out: bytes to the host; pins and world, to trace and to judge.
// Who: transports of the host, `lamplock sim`, tests. One virtual call per slice of time or piece
//      of data, none inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "shared/kinematics.hpp"
#include "sim/world/time.hpp"

namespace lamplock::sim {

class PinBus;
class World;

/// Where the loads were at the lattice tick of a shot's beat: the position without the jitter
/// of the lamp.
struct LatticeShot {
  std::uint64_t beat = 0;
  StepPosition steps{};
};

/// One board in its world. Deterministic: no threads, no wall clock.
class Board {
 public:
  virtual ~Board() = default;

  /// Name for users: "virtual", "chip".
  virtual std::string_view name() const = 0;

  /// Bytes from the host; returns how many were taken.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;
  /// Bytes to the host; returns how many.
  virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;
  virtual bool has_output() const = 0;
  /// Unplugs the cable and plugs it in again: data in it are lost, and the board sees a new
  /// connection.
  virtual void reconnect() = 0;

  /// A program of the host opens or closes the port (open from the start); on USB the board sees
  /// DTR.
  virtual void set_host_present(bool present) = 0;

  virtual void run_until(Picoseconds until) = 0;
  virtual Picoseconds now() const = 0;

  virtual PinBus& bus() = 0;
  virtual World& world() = 0;
  virtual const World& world() const = 0;
  /// One for each pulse; empty if the board cannot know.
  virtual const std::vector<LatticeShot>& lattice_shots() const = 0;
};

}  // namespace lamplock::sim
