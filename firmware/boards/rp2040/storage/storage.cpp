#include "firmware/boards/rp2040/storage/storage.hpp"

namespace lamplock::rp2040 {

settings::Values Storage::load_settings() { return settings_.load(); }
void Storage::load_program(machine::PersistentState& kept) { program_.load(kept); }
bool Storage::save(const settings::Values& values) { return settings_.save(values); }
bool Storage::save(const machine::PersistentState& kept) { return program_.save(kept); }

}  // namespace lamplock::rp2040
