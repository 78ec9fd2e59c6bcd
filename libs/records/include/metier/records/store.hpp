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

/// Filter for executions. An empty member accepts all; any other must match as a whole.
struct Filter {
    /// ApplicationUri or name of the server.
    std::string server{};
    /// BrowseName of the skill.
    std::string skill{};
    /// State: "Running", "Ready", "Halted", "Suspended", "Lost".
    std::string state{};
    /// Reason: "Finished", "ByClient", ...
    std::string reason{};
    /// Name of the user that started them.
    std::string user{};
    /// Id of the execution that started them.
    std::string parent{};
    /// Time at which or after which they started.
    /// Included itself.
    std::optional<UtcTime> from{};
    /// Time before which they started.
    /// Not included itself.
    std::optional<UtcTime> until{};
    /// Part of the reason's text or of a name (server, controller, skill, device, user, state,
    /// reason), in upper or lower case; or the whole id.
    std::string text{};
};

/// Part of a list.
/// A count outside 1 to 10,000 is changed to the nearest of these.
struct Page {
    /// Number of the last execution of the page before; 0: the first page.
    std::int64_t before = 0;
    /// Largest number of executions, 1 to 10,000.
    std::uint32_t count = 100;
};

/// Executions, newest start first.
struct Listing {
    /// Executions of this page.
    std::vector<ExecutionRow> executions{};
    /// Whether there are older ones that match.
    bool more = false;
};

/// Executions that were added or changed.
struct Changes {
    /// Executions as they are now, in the order of their last change.
    std::vector<ExecutionRow> executions{};
    /// Revision up to which they were read; pass it to the next call of changes().
    std::int64_t revision = 0;
};

/// Age and size up to which records are kept; 0: no limit.
struct Retention {
    /// Largest age since the start; 0: no limit.
    std::chrono::hours age{24 * 90};
    /// Largest size of executions and their paths [byte]; 0: no limit.
    std::uint64_t bytes = 2'000'000'000;
};

/// Whether a URL of Store::open() contains a password, which a command line would show to every
/// user of the machine. Threads: any; pure.
bool hasPassword(std::string_view url);

/// Executions that servers have recorded, in a SQLite file or a PostgreSQL database with the same
/// schema (docs/guide/history.md):
///
///     auto store = Store::open("/var/lib/metier/records.db");
///     auto page = (*store)->list({.state = "Halted"}, {.count = 20});
///
/// Threading: one thread at a time; each thread opens its own. Calls wait for the disk or the
/// database: do not call them on a server's or a cycle thread.
/// Errors of every call: resource_unavailable (disk, lock), connection_lost (PostgreSQL),
/// invalid_argument (damaged).
class Store {
public:
    /// Purpose for which a store is opened.
    enum class Access {
        /// Changes nothing; a store that does not exist is not_found.
        read,
        /// Creates file and folder (for their owner alone), or the tables.
        write,
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

    /// Finds an execution.
    /// A text of digits that is the number of no execution is looked for as an id as well.
    /// \param number_or_id a number, or else an id; the newest execution with that id is returned
    /// Errors: not_found.
    Result<ExecutionRow> find(std::string_view number_or_id);
    /// Lists executions, newest first. An unknown Page::before gives an empty list. For the next
    /// page, give the number of the last execution as Page::before.
    Result<Listing> list(const Filter& filter, const Page& page);
    /// Executions that this execution started, on any server, oldest first.
    /// \param number ExecutionRow::number, as in the functions below
    Result<std::vector<ExecutionRow>> children(std::int64_t number);
    /// Transitions, in the order of their times; empty for an unknown number.
    Result<std::vector<Transition>> transitions(std::int64_t number);
    /// Intermediate results, in the order of their times; empty for an unknown number.
    Result<std::vector<Intermediate>> intermediates(std::int64_t number);
    /// Samples of the path, in the order of their times; empty for an unknown number.
    Result<std::vector<PathSample>> path(std::int64_t number);
    /// Executions that any server added or changed after `revision`; to be called repeatedly.
    /// An execution that changed twice since comes once, as it is now.
    /// \param revision that of the last answer; latestRevision() at first. A revision that this
    ///                 store has not reached, as that of a replaced store, gives none
    Result<Changes> changes(std::int64_t revision, const Filter& filter = {},
                            std::uint32_t count = 1'000);
    /// Revision of the newest change; 0: there is none.
    Result<std::int64_t> latestRevision();

    /// Approximate size of executions and their paths [byte].
    Result<std::uint64_t> bytes();
    /// Writes a copy of all records, as they are at one moment, into a new SQLite file.
    /// \return number of executions
    /// Errors: already_exists; after any other error the file is removed.
    Result<std::uint64_t> exportTo(const std::string& file);
    /// Whether another open() would lead to the same store; false once its file was removed or
    /// replaced.
    bool isCurrent();

private:
    explicit Store(std::unique_ptr<Database> database);

    std::unique_ptr<Database> database_;
};

}  // namespace metier::records
