#pragma once

#include "metier/cell/settings.hpp"
#include "world.hpp"

namespace metier::virtual_world {

/// Reads a world's settings; errors are noted in them. virtual/world/README.md lists the settings.
WorldOptions readOptions(const cell::Settings& settings);

}  // namespace metier::virtual_world
