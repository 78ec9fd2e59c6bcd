#pragma once

#include <string>
#include <vector>

#include "chain.hpp"
#include "metier/audit/audit_log.hpp"

namespace metier::audit {

/// The file of a log, open to append.
///
/// Threading: one thread.
class AuditLog::File {
public:
    /// \param dropped how much of a last line that was not whole [byte]
    static Result<std::unique_ptr<File>> open(const std::filesystem::path& path,
                                              std::size_t& dropped);
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    /// All of them, or none.
    /// Errors: resource_unavailable, with the system's reason.
    Result<void> write(const std::vector<Entry>& entries);

private:
    File(int descriptor, std::filesystem::path path) noexcept
        : descriptor_(descriptor), path_(std::move(path)) {}
    Result<std::size_t> readEnd();

    int descriptor_;
    std::filesystem::path path_;
    std::uint64_t number_ = 0;
    std::string chain_{kNoChain};
};

}  // namespace metier::audit
