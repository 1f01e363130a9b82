#include "sim/world/random.hpp"

#include <random>

namespace lamplock::sim {

struct Random::Engine {
  std::mt19937_64 numbers;
};

Random::Random(std::uint64_t seed) : engine_(new Engine{std::mt19937_64(seed)}) {}
Random::~Random() { delete engine_; }

std::uint64_t Random::operator()() { return engine_->numbers(); }

}  // namespace lamplock::sim
