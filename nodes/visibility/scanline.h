// The algorithm stands in the kernels: visibility.spans shows it, and visibility.growth measures it.
#pragma once

#include "nodes/kernels/scan_lines.h"
