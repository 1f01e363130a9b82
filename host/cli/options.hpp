// Options that several commands share, each group in a file of its own.
#pragma once

#include "host/cli/board_options.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/mode_name.hpp"
#include "host/cli/validators.hpp"
