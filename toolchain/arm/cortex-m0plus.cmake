# Cross-compile file: freestanding code for the Arm Cortex-M0+ of the RP2040.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m0plus)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
# A freestanding program cannot be linked without the board's start-up code.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)

# All flags of code generation are in flags.txt; build types add none.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/flags.txt flag_lines REGEX "^-")
list(JOIN flag_lines " " CMAKE_CXX_FLAGS_INIT)
set(CMAKE_CXX_FLAGS_RELEASE "" CACHE STRING "" FORCE)
