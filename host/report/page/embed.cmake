# Makes page_template.cpp from the files in this folder: page.html with style and script inserted.
#
# usage: cmake -DFOLDER=host/report/page -DOUTPUT=page_template.cpp -P embed.cmake
cmake_minimum_required(VERSION 3.25)

# Reads hex digits, because CMake would interpret characters of the files.
function(read_hex name result)
  file(READ ${FOLDER}/${name} bytes HEX)
  set(${result} ${bytes} PARENT_SCOPE)
endfunction()

# Replaces a word of a text by a file.
function(put_in page word name result)
  read_hex(${name} bytes)
  string(HEX "${word}" place)
  string(REPLACE "${place}" "${bytes}" page "${page}")
  set(${result} "${page}" PARENT_SCOPE)
endfunction()

read_hex(page.html page)
put_in("${page}" "@STYLE@" page.css page)
foreach(part data cloud_colours cloud_view charts page)
  string(TOUPPER "@${part}_JS@" word)
  put_in("${page}" "${word}" ${part}.js page)
endforeach()

string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${page}")
# Lines of 32 bytes.
set(byte "0x[0-9a-f][0-9a-f],")
string(REPEAT "${byte}" 32 line)
string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "// Made of host/report/page/ by embed.cmake.
#include \"host/report/page_template.hpp\"

namespace lamplock::report {
namespace {

constexpr unsigned char bytes[] = {
${bytes}
};

}  // namespace

std::string_view page_template() {
  return {reinterpret_cast<const char*>(bytes), sizeof bytes};
}

}  // namespace lamplock::report
")
