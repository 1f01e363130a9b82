// A signed integer wide enough for products of times in picoseconds and frequencies, which exceed
// 64 bits within a second: a name for a type that is an extension of the compilers used.
// Who: the parts that convert cycles of one clock to cycles of another.
#pragma once

namespace lamplock::sim::chip {

__extension__ using Wide = __int128;

}  // namespace lamplock::sim::chip
