# Makes delivered_text.cpp from data/materials.toml.
#
# usage: cmake -DINPUT=data/materials.toml -DOUTPUT=delivered_text.cpp -P embed.cmake
cmake_minimum_required(VERSION 3.25)

# Hex digits, because CMake would interpret characters of the file.
file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
# Lines of 32 bytes.
set(byte "0x[0-9a-f][0-9a-f],")
string(REPEAT "${byte}" 32 line)
string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "// Made of data/materials.toml by embed.cmake.
#include \"host/material/delivered.hpp\"

namespace lamplock::material {
namespace {

constexpr unsigned char delivered_bytes[] = {
${bytes}
};

}  // namespace

std::string_view delivered_text() {
  return {reinterpret_cast<const char*>(delivered_bytes), sizeof delivered_bytes};
}

}  // namespace lamplock::material
")
