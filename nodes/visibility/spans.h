// The algorithm stands in the kernels, since visibility.growth measures it too.
#pragma once

#include "nodes/kernels/scan_survey.h"
