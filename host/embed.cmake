# Makes a source file whose function returns the bytes of a file.
#
# usage: cmake -DINPUT=data/materials.toml -DOUTPUT=delivered_text.cpp -DROOM=material
#          -DHEADER=host/material/delivered.hpp -DFUNCTION=delivered_text -P embed.cmake
cmake_minimum_required(VERSION 3.25)

# Hex digits, because CMake would interpret characters of the file.
file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
# Lines of 32 bytes.
set(byte "0x[0-9a-f][0-9a-f],")
string(REPEAT "${byte}" 32 line)
string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
get_filename_component(name ${INPUT} NAME)
file(WRITE ${OUTPUT} "// Made of ${name} by embed.cmake.
#include \"${HEADER}\"

namespace lamplock::${ROOM} {
namespace {

constexpr unsigned char ${FUNCTION}_bytes[] = {
${bytes}
};

}  // namespace

std::string_view ${FUNCTION}() {
  return {reinterpret_cast<const char*>(${FUNCTION}_bytes), sizeof ${FUNCTION}_bytes};
}

}  // namespace lamplock::${ROOM}
")
