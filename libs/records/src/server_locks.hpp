#pragma once

#include <memory>
#include <string>
#include <utility>

#include "metier/base/error.hpp"

namespace metier::records {

/// Signs of the servers that record into a SQLite file: each holds a lock on the byte of its name
/// in a file beside it. The kernel frees it with its process, also after kill -9.
///
/// Threading: one thread at a time.
class ServerLocks {
public:
    /// Creates the file, for its owner alone. Shared by the holders of names.
    /// Errors: resource_unavailable.
    static Result<std::shared_ptr<ServerLocks>> open(const std::string& file);
    /// Frees what it holds.
    ~ServerLocks();
    ServerLocks(const ServerLocks&) = delete;
    ServerLocks& operator=(const ServerLocks&) = delete;

    /// Several may hold the same name. Errors: resource_unavailable.
    Result<void> hold(const std::string& server) const;
    /// Whether another one than this holds it. Errors: resource_unavailable.
    Result<bool> isHeldByOthers(const std::string& server) const;

private:
    ServerLocks(int descriptor, std::string name)
        : descriptor_(descriptor), name_(std::move(name)) {}
    tl::unexpected<Error> failed() const;

    const int descriptor_;
    const std::string name_;  // for messages
};

}  // namespace metier::records
