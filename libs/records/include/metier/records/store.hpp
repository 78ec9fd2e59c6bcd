#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/records/execution_row.hpp"

namespace metier::records {

class Database;

/// Executions that are wanted. An empty member takes all; one that is not must fit as a whole.
struct Filter {
    std::string server{};  ///< ApplicationUri or name of the server
    std::string skill{};   ///< BrowseName
    std::string state{};   ///< "Running", "Ready", "Halted", "Suspended", "Lost"
    std::string reason{};  ///< "Finished", "ByClient", ...
    std::string user{};
    std::string parent{};            ///< id of the execution that started them
    std::optional<UtcTime> from{};   ///< started at that time or later
    std::optional<UtcTime> until{};  ///< started before that time
    /// Part of the reason's text or of a name (server, controller, skill, device, user, state,
    /// reason), in upper or lower case; or the whole id.
    std::string text{};
};

/// A part of a list.
struct Page {
    std::int64_t before = 0;    ///< number of the last one of the page before; 0: the first page
    std::uint32_t count = 100;  ///< most that are wanted, 1 to 10,000
};

/// Executions, newest start first.
struct Listing {
    std::vector<ExecutionRow> executions{};
    bool more = false;  ///< older ones fit, too
};

/// Executions that came or changed.
struct Changes {
    std::vector<ExecutionRow> executions{};  ///< as they are now, in the order of their last change
    std::int64_t revision = 0;            ///< to go on from
};

/// Age and size up to which records are kept; 0: without bound.
struct Retention {
    std::chrono::hours age{24 * 90};      ///< since the start
    std::uint64_t bytes = 2'000'000'000;  ///< in use by executions and their paths
};

/// Whether a URL of Store::open() has a password in it, which a command line would show to every
/// user of the machine. Threads: any; pure.
bool hasPassword(std::string_view url);

/// The executions that servers have recorded, in a SQLite file or a PostgreSQL database with the
/// same schema (docs/guide/history.md).
///
/// Threading: one thread at a time; each thread opens its own. Calls wait for the disk or the
/// database, so none belongs into a server's or a cycle's thread.
/// Errors of every call: resource_unavailable (disk, lock), connection_lost (PostgreSQL),
///                       invalid_argument (damaged).
class Store {
public:
    enum class Access {
        read,   ///< changes nothing; what does not exist is not_found
        write,  ///< makes file and folder (for their owner alone), or the tables
    };

    /// \param url a file, "sqlite:FILE", or "postgresql://USER@HOST/DATABASE" as libpq takes it
    /// Errors: not_found; invalid_argument (no such URL; not a store of records: it stays as it
    ///         is); not_supported (a later schema than this program knows);
    ///         resource_unavailable, connection_lost.
    static Result<std::unique_ptr<Store>> open(const std::string& url,
                                               Access access = Access::read);
    ~Store();
    Store(const Store&) = delete;
    Store& operator=(const Store&) = delete;

    /// \param number_or_id a number, or else an id; the newest one that has it
    /// Errors: not_found.
    Result<ExecutionRow> find(std::string_view number_or_id);
    /// An unknown Page::before gives nothing.
    Result<Listing> list(const Filter& filter, const Page& page);
    /// Executions that the execution started, on whichever server, oldest first.
    Result<std::vector<ExecutionRow>> children(std::int64_t number);
    /// In the order of their times; nothing for an unknown number. The same for the next two.
    Result<std::vector<Transition>> transitions(std::int64_t number);
    Result<std::vector<Intermediate>> intermediates(std::int64_t number);
    Result<std::vector<PathSample>> path(std::int64_t number);
    /// Executions that came or changed after `revision`, by any server; to be asked again and
    /// again. \param revision of the last answer, or of latestRevision() to begin with. One that
    /// this store
    ///                 has not reached, of a store that was here before, gives none
    Result<Changes> changes(std::int64_t revision, const Filter& filter = {},
                            std::uint32_t count = 1'000);
    Result<std::int64_t> latestRevision();

    /// Removes the oldest executions that are over, a part at a time.
    /// \return how many. Needs Access::write.
    Result<std::uint64_t> retain(const Retention& keep, UtcTime now);
    /// Space of executions and their paths [byte], about.
    Result<std::uint64_t> bytes();
    /// Writes a copy of all records, as they are at one moment, into a SQLite file that is made.
    /// \return how many executions. Errors: already_exists; the file is removed after any other.
    Result<std::uint64_t> exportTo(const std::string& file);
    /// Whether another open() would lead to the same store: false once a file was removed or
    /// replaced.
    bool isCurrent();

private:
    explicit Store(std::unique_ptr<Database> database);

    std::unique_ptr<Database> database_;
};

}  // namespace metier::records
