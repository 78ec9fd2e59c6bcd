#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

#include "chain.hpp"
#include "metier/security/audit_log.hpp"
#include "private_file.hpp"

namespace metier::security {

/// The last part of a log, open for appending; no other process has the log open.
///
/// Threading: one thread.
class AuditLog::File {
public:
    /// \param part_size [byte]
    /// \param dropped how much of a last line that was not whole [byte]
    static Result<std::unique_ptr<File>> open(const std::filesystem::path& path,
                                              std::uintmax_t part_size, std::size_t& dropped);
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    /// All of them, or none.
    /// Errors: resource_unavailable, with the system's reason.
    Result<void> write(const std::vector<Entry>& entries);
    /// Chain value of the newest line.
    const std::string& chain() const noexcept { return chain_; }

private:
    File(std::filesystem::path log, std::uintmax_t part_size) noexcept
        : log_(std::move(log)), part_size_(part_size) {}
    /// Lines to write, and the state of the chain after they are written.
    struct Batch {
        std::string text;
        std::uint64_t number = 0;
        std::string chain;
    };
    Batch chained(const std::vector<Entry>& entries, bool at_begin) const;
    Result<void> lock();
    Result<std::size_t> readEnds();
    void goOnInNextPart(off_t size);

    const std::filesystem::path log_;
    const std::uintmax_t part_size_;
    Descriptor first_part_;  // keeps the lock
    Descriptor part_;
    std::uint32_t part_number_ = 1;
    std::uint64_t number_ = 0;
    std::string chain_{kNoChain};
};

}  // namespace metier::security
