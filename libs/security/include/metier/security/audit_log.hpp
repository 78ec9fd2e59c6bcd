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

/// Something that somebody did, or was not let do.
struct Entry {
    UtcTime time;
    std::string event;  ///< "Start", "Halt", "LoginRefused"
    /// Who, where, what came of it; in this order in the file. Text that is not UTF-8 is made so,
    /// and cut after 1000 bytes.
    std::vector<std::pair<std::string, std::string>> fields;
};

/// What the file of a log can be in.
enum class WriteState {
    writing,
    failing,  ///< nothing can be written: entries are kept, and some may be lost
};

/// A file that only grows: a JSON object in each line, chained to the one before by SHA-256.
/// Beyond `part_size` it goes on in another one: "a.log", "a.2.log", "a.3.log", ..., the chain too.
/// No part is ever removed.
///
/// Whoever changes, removes or inserts a line breaks the chain, which verify() tells. Lines
/// cut off at the end show to those who kept a chain value, see anchor(). What is
/// appended is in the file a second later at most; a slow or full disk delays nobody but the log's
/// own thread. Beyond 10,000 waiting entries new ones are lost, and their number is written once
/// that is possible. Threading: any thread may append.
class AuditLog {
public:
    struct Options {
        std::filesystem::path file;
        /// On the log's thread, at each change; with the reason. May be empty.
        std::function<void(WriteState, const std::string& why)> on_write_state;
        std::uintmax_t part_size = std::uintmax_t{64} << 20U;  ///< [byte] about
    };

    /// Goes on where the file ends, or its last part. Others may not read it, nor its folder if
    /// that is new. A last line that is not whole, as after a loss of power, is
    /// dropped, which an entry tells.
    /// Errors: resource_unavailable (the file, also if another log has it open);
    ///         invalid_argument (it is no audit log).
    static Result<std::unique_ptr<AuditLog>> open(Options options);
    /// Writes what is waiting, unless the disk refuses it.
    ~AuditLog();
    AuditLog(const AuditLog&) = delete;
    AuditLog& operator=(const AuditLog&) = delete;

    /// Returns at once.
    void append(Entry entry);
    /// Entries that are not in the file yet.
    std::size_t waiting() const;
    /// Waits until all that was appended before is in the file; false at the deadline.
    bool flush(SteadyTime deadline);
    /// Chain value of the newest line in the file, 64 hexadecimal digits; zeros: there is none.
    /// Kept elsewhere it shows later whether lines were cut off, see verify().
    std::string anchor() const;

private:
    class File;
    AuditLog(Options options, std::unique_ptr<File> file);
    void run(const std::stop_token& stop);
    bool write(const std::vector<Entry>& entries, std::uint64_t lost);
    void tell(WriteState write_state, const std::string& why);

    const Options options_;
    std::unique_ptr<File> file_;  // of the thread
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

/// What a log that was not tampered with holds.
struct Verified {
    std::uint64_t entries = 0;
    std::uint64_t first_number = 1;  ///< more: what came before is in another part
    std::string first_time;          ///< empty if there is no entry
    std::string last_time;
    std::string last_chain;  ///< 64 hexadecimal digits
    /// Those of the given anchors that are chain values of this log.
    std::set<std::string> anchors{};
};

/// Reads the whole file and the parts that follow it.
/// \param anchors chain values that were newest once, see AuditLog::anchor()
/// Errors: not_found, naming the part; invalid_argument, naming the first line that is not as it
///         was written.
Result<Verified> verify(const std::filesystem::path& file,
                        const std::set<std::string>& anchors = {});

/// The file and the parts that follow it, in their order.
std::vector<std::filesystem::path> partsOf(const std::filesystem::path& file);

}  // namespace metier::security
