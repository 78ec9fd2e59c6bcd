#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::security {

/// An act of a user or application that was done or refused.
struct Entry {
    /// Wall clock of the act; printed in UTC.
    UtcTime time;
    /// Word for the act: "Start", "Halt", "LoginRefused".
    std::string event;
    /// Names and values, such as the user, the place and the outcome; in this order in the file.
    /// Text that is not UTF-8 is converted, and cut after 1000 bytes.
    std::vector<std::pair<std::string, std::string>> fields;
};

/// State of a log's file.
enum class WriteState {
    /// Entries reach the file.
    writing,
    /// Nothing can be written: entries wait, and some may be lost.
    failing,
};

/// A log file that only grows: one JSON object per line, each chained to the line before by
/// SHA-256. Beyond `part_size` the log and its chain go on in a further file: "a.log", "a.2.log",
/// "a.3.log", ... No part is ever removed.
///
///     auto log = AuditLog::open({.file = "audit.log"});
///     (*log)->append({now, "Start", {{"user", "anna"}, {"skill", "JointPtpMoveSkill"}}});
///
/// A changed, removed or inserted line breaks the chain, which verify() reports. Lines cut off at
/// the end are noticed only with a chain value that was kept elsewhere, see anchor(). An entry is
/// in the file a second after append() at most; a slow or full disk delays only the log's own
/// thread. Beyond 10,000 waiting entries new ones are lost; their number is written once that is
/// possible.
/// Threading: any thread may append.
class AuditLog {
public:
    /// Settings of a log.
    struct Options {
        /// File of the first part; its folder is made if it is missing.
        std::filesystem::path file;
        /// Called on the log's thread at each change between writing and failing, with the reason.
        /// May be empty.
        std::function<void(WriteState, const std::string& why)> on_write_state;
        /// Size after which a further part is begun [byte], about.
        std::uintmax_t part_size = std::uintmax_t{64} << 20U;
    };

    /// Opens the log and goes on at the end of its last part. Other users may not read the file,
    /// nor its folder if this call makes it. An incomplete last line, as after a loss of power, is
    /// dropped, and an entry reports that.
    /// Errors: resource_unavailable (the file, also if another log has it open);
    ///         invalid_argument (it is no audit log).
    static Result<std::unique_ptr<AuditLog>> open(Options options);
    /// Writes waiting entries, unless the disk refuses them; waits for the disk.
    ~AuditLog();
    AuditLog(const AuditLog&) = delete;
    AuditLog& operator=(const AuditLog&) = delete;

    /// Adds an entry; returns at once, does not wait for the disk. Beyond 10,000 waiting entries it
    /// is lost.
    void append(Entry entry);
    /// Number of entries that are not in the file yet.
    std::size_t waiting() const;
    /// Waits until all entries appended before are in the file; false at the deadline. Not for a
    /// server's thread.
    bool flush(SteadyTime deadline);
    /// Chain value of the newest line in the file, 64 hexadecimal digits; zeros if there is no
    /// line. A copy kept elsewhere shows later whether lines were cut off, see verify().
    std::string anchor() const;

private:
    class File;
    AuditLog(Options options, std::unique_ptr<File> file);
    void run(const std::stop_token& stop);
    bool write(const std::vector<Entry>& entries, std::uint64_t lost);
    void tell(WriteState write_state, const std::string& why);

    const Options options_;
    std::unique_ptr<File> file_;  // used by the log's thread only
    WriteState write_state_ = WriteState::writing;
    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<Entry> waiting_;
    std::uint64_t lost_ = 0;
    std::uint64_t appended_ = 0;
    std::uint64_t written_ = 0;
    std::string anchor_;
    std::jthread thread_;
};

/// Content of a log whose chain is intact.
struct Verified {
    /// Number of entries.
    std::uint64_t entries = 0;
    /// Number of the first entry; above 1: earlier entries are in another part.
    std::uint64_t first_number = 1;
    /// Time of the first entry; empty if there is no entry.
    std::string first_time{};
    /// Time of the last entry; empty if there is no entry.
    std::string last_time{};
    /// Chain value of the last line, 64 hexadecimal digits.
    std::string last_chain{};
    /// Given anchors that are chain values of this log.
    std::set<std::string> anchors{};
};

/// Checks the chain of the whole file and of the parts that follow it. Waits for the disk.
/// \param anchors chain values kept from earlier, see AuditLog::anchor()
/// Errors: not_found, naming the part; invalid_argument, naming the first line that differs from
///         what the log wrote.
Result<Verified> verify(const std::filesystem::path& file,
                        const std::set<std::string>& anchors = {});

/// Paths of the file and of the parts that follow it, in their order.
std::vector<std::filesystem::path> partsOf(const std::filesystem::path& file);

}  // namespace metier::security
