#pragma once

#include <unistd.h>

#include <optional>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/link/name_lock.hpp"

namespace metier::server {

/// The name of a server's port, so that a second server is told at once which process has it. The
/// kernel lets one process have the port anyway.
///
/// Another user who took the name without the port keeps nobody from serving there: that is logged,
/// and the result empty, as for any free port.
/// \param own user of this process
/// Errors: as link::NameLock::take(), while the port is taken.
Result<std::optional<link::NameLock>> lockPort(const cell::ServerConfig& config,
                                               uid_t own = geteuid());

}  // namespace metier::server
