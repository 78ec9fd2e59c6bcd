#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <thread>

#include "board.hpp"
#include "metier/http/httplib.hpp"
#include "metier/records/execution.hpp"
#include "metier/records/store.hpp"
#include "reply.hpp"

namespace metier::dashboard {

/// What servers have recorded, as the page shows it; has the board told of what is new while
/// somebody looks.
///
/// Threading: any; a thread of its own looks for what is new, twice a second.
class RecordsView {
public:
    /// \param url   as records::Store::open() takes it; empty: nothing is recorded
    /// \param board must outlive this
    RecordsView(std::string url, Board& board);

    /// GET /api/records. Waits for the disk.
    Reply list(const httplib::Request& request) const;
    /// GET /api/records/NUMBER. Waits for the disk.
    Reply one(std::int64_t number) const;
    /// Whether somebody looks.
    void show(bool shown);

private:
    Result<std::unique_ptr<records::Store>> open() const;
    nlohmann::json recordJson(const records::Execution& execution) const;
    void work(const std::stop_token& stop);
    /// Looks for changes, in a store that is opened when it is there.
    void look(std::unique_ptr<records::Store>& store, std::int64_t& revision) const;

    const std::string url_;
    Board& board_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool shown_ = false;
    std::jthread thread_;  // last: it uses everything above
};

/// What a request asks for. Errors: invalid_argument, naming what is wrong.
Result<std::pair<records::Filter, records::Page>> recordsQuery(const httplib::Request& request);

}  // namespace metier::dashboard
