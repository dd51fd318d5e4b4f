// The algorithm stands in the kernels, since visibility.growth measures it too.
#pragma once

#include "nodes/kernels/depth_sort.h"
