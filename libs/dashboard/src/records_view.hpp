#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "board.hpp"
#include "metier/http/httplib.hpp"
#include "metier/records/execution_row.hpp"
#include "metier/records/kept_store.hpp"
#include "metier/records/store.hpp"
#include "reply.hpp"

namespace metier::dashboard {

/// Records of servers as the page shows them. Reports new ones to the board while a tab shows them.
/// The store is opened once and kept.
///
/// Threading: any; a thread of its own looks for new records, twice a second.
class RecordsView {
public:
    /// \param url   as records::Store::open() takes it; empty: nothing is recorded
    /// \param board must outlive this
    RecordsView(std::string url, Board& board);

    /// GET /api/records. Waits for the disk.
    Reply list(const httplib::Request& request);
    /// GET /api/records/NUMBER. Waits for the disk.
    Reply one(std::int64_t number);
    /// Sets whether a tab shows the records.
    void show(bool shown);

private:
    nlohmann::json recordJson(const records::ExecutionRow& execution) const;
    Result<nlohmann::json> detailsOf(records::Store& store, std::int64_t number) const;
    void work(const std::stop_token& stop);
    /// Looks for changes. \param revision of the look before; nothing before the first
    void look(std::optional<std::int64_t>& revision);

    const bool recorded_;
    records::KeptStore store_;
    Board& board_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool shown_ = false;
    std::jthread thread_;  // last: it uses everything above
};

/// The records that a request asks for. Errors: invalid_argument, naming what is wrong.
Result<std::pair<records::Filter, records::Page>> recordsQuery(const httplib::Request& request);

}  // namespace metier::dashboard
