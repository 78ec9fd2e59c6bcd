#pragma once

#include <unistd.h>

#include <string>

#include "metier/base/error.hpp"

namespace metier::link {

/// A name that one process of this machine has at a time, whatever user or folder it runs in. Any
/// user of the machine can take a name, so that nothing but a start can be kept off by it.
///
/// The kernel frees it with its process, also after kill -9; there is no file that could be left
/// over. Processes in different network namespaces do not see each other's names, as they do not
/// see each other's ports: it is an abstract Unix socket.
///
/// Threading: any thread, one at a time.
class NameLock {
public:
    /// \param name at most some hundred characters; what differs only beyond is told apart, too
    /// \param what is locked, for the error
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
