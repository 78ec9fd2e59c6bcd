#pragma once

#include <unistd.h>

#include <string>

#include "metier/base/error.hpp"

namespace metier::link {

/// A name that only one process of this machine holds at a time, whatever its user and folder. Any
/// user of the machine can take any name, so a lock may prevent no more than the start of a
/// program.
///
/// It is an abstract Unix socket: the kernel frees the name when the process ends, also after kill
/// -9, and no file is left behind. Processes in different network namespaces do not see each
/// other's names, just as they do not see each other's ports.
///
/// Threading: any thread, one at a time.
class NameLock {
public:
    /// \param name any length; long names that differ only near their end are different names, too
    /// \param what the locked thing, for the error text
    /// \param own  user of this process
    /// Errors: already_exists, with `what` and the pid of the process that has it, this one
    ///         included; access_denied, the same, if that process is of another user, who is not
    ///         root; resource_unavailable.
    static Result<NameLock> take(const std::string& name, const std::string& what,
                                 uid_t own = geteuid());

    NameLock(NameLock&& other) noexcept;
    NameLock& operator=(NameLock&& other) noexcept;
    /// Frees the name.
    ~NameLock();

private:
    explicit NameLock(int socket) : socket_(socket) {}

    int socket_;
};

}  // namespace metier::link
