#pragma once

#include <unistd.h>

#include <optional>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/link/name_lock.hpp"

namespace metier::server {

/// Takes the name of a server's port, so that a second server can report at once which process has
/// the port. (The kernel gives the port to one process only, in any case.)
///
/// If another user took the name but not the port, the server may serve all the same: that is
/// logged, and the result is empty, as for any free port.
/// \param own user id of this process
/// Errors: as link::NameLock::take(), while the port is taken.
Result<std::optional<link::NameLock>> lockPort(const cell::ServerConfig& config,
                                               uid_t own = geteuid());

}  // namespace metier::server
