#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "metier/link/child_process.hpp"

namespace metier::records {

/// A PostgreSQL server of this test program alone: in a folder below /tmp, reached by a socket
/// there, run by an unprivileged user. Ends with this object.
class TemporaryPostgres {
public:
    /// The one of this program, started at the first call; nullptr with the reason on standard
    /// error if PostgreSQL is not installed here.
    static TemporaryPostgres* instance();

    ~TemporaryPostgres();
    TemporaryPostgres(const TemporaryPostgres&) = delete;
    TemporaryPostgres& operator=(const TemporaryPostgres&) = delete;

    /// URL of a database that did not exist before.
    std::string freshDatabase();
    /// As after a crash of its machine; comes back with start().
    void kill();
    void start();

private:
    explicit TemporaryPostgres(std::filesystem::path programs);
    void run(const std::vector<std::string>& command) const;

    const std::filesystem::path programs_;
    const std::filesystem::path folder_;
    std::unique_ptr<link::ChildProcess> server_;
    int databases_ = 0;
};

}  // namespace metier::records
