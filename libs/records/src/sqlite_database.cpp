#include "sqlite_database.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <mutex>
#include <system_error>

namespace metier::records {
namespace {

namespace fs = std::filesystem;

constexpr Dialect kDialect{
    .number_key = "INTEGER PRIMARY KEY AUTOINCREMENT",
    .blob = "BLOB",
    .tables = "SELECT name FROM sqlite_master WHERE type = 'table'",
    .bytes =
        "SELECT (page_count - freelist_count) * page_size FROM pragma_page_count(), "
        "pragma_freelist_count(), pragma_page_size()",
    .shrink = "PRAGMA incremental_vacuum; PRAGMA wal_checkpoint(TRUNCATE)"};
/// Longest wait for others that write; only on a thread that may wait. A recorder tries again; a
/// reader waits only for the last user, while that closes a file.
constexpr std::chrono::milliseconds kLongestWrite{2'000};
constexpr std::chrono::milliseconds kLongestRead{10'000};
/// Statements that are kept; lists make many that are used once.
constexpr int kLockPauseMs = 5;
constexpr std::size_t kMostStatements = 64;
constexpr mode_t kOwnerOnly = 0600;

/// Makes the folder and the empty file, which others may not read.
Result<void> makeFile(const fs::path& file) {
    std::error_code error;  // opening the file shows what is wrong
    if (file.has_parent_path() && fs::create_directories(file.parent_path(), error)) {
        fs::permissions(file.parent_path(), fs::perms::owner_all, error);
    }
    // Closing a file frees all locks that the process has on it, those of other connections as
    // well: it is opened here only if it is new, and no other thread connects before it is closed.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    const int made = ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly);
    if (made < 0 && errno == EEXIST) {
        return {};
    }
    if (made < 0) {
        return fail(Errc::resource_unavailable,
                    fmt::format("{}: {}", file.string(), std::generic_category().message(errno)));
    }
    ::close(made);
    return {};
}

/// Percent-encoded, as SQLite takes it in a URI.
std::string encoded(std::string_view path) {
    std::string text;
    for (const char c : path) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' ||
                           c == '.' || c == '-' || c == '_';
        text += plain
                    ? std::string(1, c)
                    : fmt::format("%{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
    return text;
}

/// Turns off SQLite's counts of its memory, which need a lock and are not used. Call it before its
/// first use.
void withoutMemoryCounts() {
    static std::once_flag once;
    std::call_once(once, [] { sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0); });
}

Errc codeOf(int status) {
    switch (status) {
        case SQLITE_CORRUPT:
        case SQLITE_NOTADB:
            return Errc::invalid_argument;
        case SQLITE_ERROR:
        case SQLITE_MISUSE:
        case SQLITE_RANGE:
            return Errc::internal;
        case SQLITE_BUSY:      // others have had it locked for kLongestWrite
        case SQLITE_PROTOCOL:  // others have begun to read or write again and again
            return Errc::timeout;
        default:
            return Errc::resource_unavailable;
    }
}

int bind(sqlite3_stmt* statement, int index, const Argument& argument) {
    if (const auto* number = std::get_if<std::int64_t>(&argument)) {
        return sqlite3_bind_int64(statement, index, *number);
    }
    if (const auto* text = std::get_if<std::string_view>(&argument)) {
        return sqlite3_bind_text64(statement, index, text->empty() ? "" : text->data(),
                                   text->size(), SQLITE_STATIC, SQLITE_UTF8);
    }
    const auto& bytes = std::get<std::span<const std::uint8_t>>(argument);
    return sqlite3_bind_blob64(statement, index,
                               bytes.empty() ? "" : static_cast<const void*>(bytes.data()),
                               bytes.size(), SQLITE_STATIC);
}

Cell column(sqlite3_stmt* statement, int index) {
    const auto size = [&] {
        return static_cast<std::size_t>(sqlite3_column_bytes(statement, index));
    };
    switch (sqlite3_column_type(statement, index)) {
        case SQLITE_TEXT: {
            const auto* text = static_cast<const char*>(sqlite3_column_blob(statement, index));
            return text == nullptr ? std::string() : std::string(text, size());
        }
        case SQLITE_BLOB: {
            const auto* bytes =
                static_cast<const std::uint8_t*>(sqlite3_column_blob(statement, index));
            return bytes == nullptr ? Bytes() : Bytes(bytes, bytes + size());
        }
        default:
            return static_cast<std::int64_t>(sqlite3_column_int64(statement, index));
    }
}

Row rowOf(sqlite3_stmt* statement) {
    std::vector<Cell> cells;
    const int count = sqlite3_column_count(statement);
    cells.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        cells.push_back(column(statement, i));
    }
    return Row(std::move(cells));
}

}  // namespace

void SqliteDatabase::Close::operator()(sqlite3* connection) const noexcept {
    sqlite3_close_v2(connection);
}

void SqliteDatabase::Close::operator()(sqlite3_stmt* statement) const noexcept {
    sqlite3_finalize(statement);
}

SqliteDatabase::~SqliteDatabase() = default;

const Dialect& SqliteDatabase::dialect() const noexcept {
    return kDialect;
}

Result<std::unique_ptr<Database>> SqliteDatabase::open(const fs::path& file, Store::Access access) {
    std::error_code none;
    if (access == Store::Access::read && !fs::exists(file, none)) {
        return fail(Errc::not_found, fmt::format("{}: there are no records", file.string()));
    }
    if (fs::is_directory(file, none)) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} is a folder, no file of records", file.string()));
    }
    if (access == Store::Access::write) {
        METIER_TRY(makeFile(file));
    }
    std::unique_ptr<SqliteDatabase> database(new SqliteDatabase(file.string()));
    METIER_TRY(database->connect(access));
    METIER_TRY(database->setUp(access));
    return std::unique_ptr<Database>(std::move(database));
}

Result<void> SqliteDatabase::connect(Store::Access access) {
    withoutMemoryCounts();
    std::error_code none;
    auto uri = "file:" + encoded(fs::absolute(name_, none).string());
    const bool read_only_folder =
        access == Store::Access::read &&
        ::access(fs::absolute(name_, none).parent_path().c_str(), W_OK) != 0;
    // A reader needs the files beside it, too. In a folder that it cannot write they exist only
    // while a server writes. Without them nobody writes.
    if (read_only_folder && !fs::exists(name_ + "-wal", none)) {
        uri += "?immutable=1";
    }
    const int flags =
        (access == Store::Access::read ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE) |
        SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX;
    sqlite3* connection = nullptr;
    const int status = sqlite3_open_v2(uri.c_str(), &connection, flags, nullptr);
    connection_.reset(connection);
    if (status != SQLITE_OK) {
        return failed();
    }
    const auto longest = access == Store::Access::read ? kLongestRead : kLongestWrite;
    sqlite3_busy_timeout(connection, static_cast<int>(longest.count()));
    return {};
}

Result<void> SqliteDatabase::setUp(Store::Access access) {
    if (access == Store::Access::read) {
        return script("PRAGMA query_only = 1");
    }
    // If two connections change a new file to WAL at once, SQLite refuses one without waiting.
    const auto end = std::chrono::steady_clock::now() + kLongestWrite;
    while (true) {
        // auto_vacuum takes effect only before the first table; it lets space be given back.
        auto done = script(
            "PRAGMA auto_vacuum = INCREMENTAL; PRAGMA journal_mode = WAL;"
            "PRAGMA synchronous = FULL; PRAGMA journal_size_limit = 16777216;"
            "PRAGMA wal_autocheckpoint = 4096; PRAGMA temp_store = MEMORY");
        if (done || done.error().code != Errc::timeout || std::chrono::steady_clock::now() >= end) {
            return done;
        }
        sqlite3_sleep(kLockPauseMs);
    }
}

tl::unexpected<Error> SqliteDatabase::failed() const {
    if (connection_ == nullptr) {
        return fail(Errc::resource_unavailable, name_ + ": no memory");
    }
    const int status = sqlite3_errcode(connection_.get());
    const auto* why = sqlite3_errmsg(connection_.get());
    return fail(codeOf(status), status == SQLITE_NOTADB ? fmt::format("{} is no SQLite file", name_)
                                                        : fmt::format("{}: {}", name_, why));
}

Result<sqlite3_stmt*> SqliteDatabase::prepared(std::string_view sql) {
    if (const auto known = statements_.find(sql); known != statements_.end()) {
        return known->second.get();
    }
    if (statements_.size() >= kMostStatements) {
        statements_.clear();
    }
    // SQLite counts parameters named $1 as they come, and ?1 by its number.
    std::string numbered(sql);
    std::replace(numbered.begin(), numbered.end(), '$', '?');
    sqlite3_stmt* made = nullptr;
    if (sqlite3_prepare_v2(connection_.get(), numbered.c_str(), -1, &made, nullptr) != SQLITE_OK) {
        return failed();
    }
    statements_[std::string(sql)].reset(made);
    return made;
}

Result<Rows> SqliteDatabase::execute(std::string_view sql, std::span<const Argument> parameters) {
    METIER_ASSIGN(const auto found, prepared(sql));
    auto* const statement = found;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (bind(statement, static_cast<int>(i) + 1, parameters[i]) != SQLITE_OK) {
            return failed();
        }
    }
    Rows rows;
    int status = sqlite3_step(statement);
    for (; status == SQLITE_ROW; status = sqlite3_step(statement)) {
        rows.push_back(rowOf(statement));
    }
    auto result = status == SQLITE_DONE ? Result<Rows>(std::move(rows)) : Result<Rows>(failed());
    sqlite3_reset(statement);
    sqlite3_clear_bindings(statement);
    return result;
}

Result<void> SqliteDatabase::script(const std::string& sql) {
    return sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK
               ? Result<void>()
               : Result<void>(failed());
}

void SqliteDatabase::rollBack() noexcept {
    if (sqlite3_get_autocommit(connection_.get()) == 0) {
        sqlite3_exec(connection_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
    }
}

Result<Presence> SqliteDatabase::attend(const std::string& server) {
    return ServerLocks::open(name_ + "-servers").and_then([&](const auto& locks) {
        return locks->hold(server).map([&] { return Presence(locks); });
    });
}

Result<bool> SqliteDatabase::isAttendedByOthers(const std::string& server) {
    return ServerLocks::open(name_ + "-servers").and_then([&](const auto& locks) {
        return locks->isHeldByOthers(server);
    });
}

bool SqliteDatabase::isCurrent() {
    int moved = 0;
    sqlite3_file_control(connection_.get(), nullptr, SQLITE_FCNTL_HAS_MOVED, &moved);
    return moved == 0;
}

}  // namespace metier::records
