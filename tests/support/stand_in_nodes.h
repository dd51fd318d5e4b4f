// Node types with the ports and parameters of real ones and nothing behind them, for tests of what is checked before
// anything runs: those tests hold whatever becomes of the real nodes.
#pragma once

#include "runtime/core/registry.h"

namespace frustum::test {

const Registry& stand_in_nodes();

}  // namespace frustum::test
