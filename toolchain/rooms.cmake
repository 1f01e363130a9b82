# Rooms: a folder of the source tree is a library of its own, with its own optimisation.
#
# add_room(NAME FOLDERS folder... [EXCEPT regex] [OPTIMIZE level] [BATCH files] [ALONE regex]
#          [FAST regex]
#          [PUBLIC target...] [PRIVATE target...])
#   NAME       target; the library is lamplock_NAME
#   FOLDERS    below the current folder; all .cpp files in them and below; a new file needs no entry
#   EXCEPT     omits the paths that match
#   OPTIMIZE   1 (default), 2 or 3, in the configuration Release. 3 is for code whose speed users
#              notice: it doubles the time to compile a file. Under the sanitizers, whose checks
#              take long to optimise, such rooms have level 2, the others 0
#   BATCH      files that are compiled as one unit, since most of the time goes into their common
#              headers; 1: each file by itself. So names in anonymous namespaces of a room differ
#   ALONE      keeps the paths that match out of batches: files that name registers, and hot
#              ones, into which the compiler inlines less when they are part of a large unit
#   FAST       files that match are compiled alone with level 3
#   PUBLIC     rooms and libraries that its headers include, PRIVATE: those that only its sources do
function(add_room name)
  cmake_parse_arguments(ROOM "" "EXCEPT;OPTIMIZE;BATCH;ALONE;FAST" "FOLDERS;PUBLIC;PRIVATE" ${ARGN})
  set(sources)
  foreach(folder ${ROOM_FOLDERS})
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  if(ROOM_EXCEPT)
    list(FILTER sources EXCLUDE REGEX "${ROOM_EXCEPT}")
  endif()
  add_library(lamplock_${name} STATIC ${sources})
  target_link_libraries(lamplock_${name} PUBLIC lamplock_options ${ROOM_PUBLIC}
    PRIVATE ${ROOM_PRIVATE})
  if(NOT DEFINED ROOM_BATCH)
    set(ROOM_BATCH 16)
  endif()
  if(LAMPLOCK_BATCHES AND ROOM_BATCH GREATER 1)
    set_target_properties(lamplock_${name} PROPERTIES UNITY_BUILD ON
      UNITY_BUILD_BATCH_SIZE ${ROOM_BATCH})
  endif()
  foreach(source ${sources})
    if(ROOM_FAST AND source MATCHES "${ROOM_FAST}")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON
        COMPILE_OPTIONS $<IF:$<CONFIG:Release>,-O3,-O2>)
    elseif(ROOM_ALONE AND source MATCHES "${ROOM_ALONE}")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
  # Third-party libraries assert on bad input, for which lamplock has its own errors.
  target_compile_definitions(lamplock_${name} PRIVATE $<$<CONFIG:Release>:NDEBUG>)
  if(ROOM_OPTIMIZE)
    target_compile_options(lamplock_${name} PRIVATE
      $<IF:$<CONFIG:Release>,-O${ROOM_OPTIMIZE},-O2>)
  endif()
endfunction()

# rooms_first(PROGRAM ROOM...): under the sanitizers, links the optimised rooms of a program that runs
# them for a long time before the others. The linker takes inline functions from the first object that
# has them, and most objects have them at level 0.
function(rooms_first program)
  if(NOT LAMPLOCK_SANITIZED)
    return()
  endif()
  foreach(room ${ARGN})
    target_link_options(${program} PRIVATE
      LINKER:--whole-archive,$<TARGET_FILE:lamplock_${room}>,--no-whole-archive)
  endforeach()
endfunction()
