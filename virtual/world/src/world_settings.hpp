#pragma once

#include "metier/cell/settings.hpp"
#include "world.hpp"

namespace metier::virtual_world {

/// Reads a world's settings; what is wrong is noted in them. virtual/world/README.md lists them.
WorldOptions readOptions(const cell::Settings& settings);

}  // namespace metier::virtual_world
