#pragma once

#include "metier/http/httplib.hpp"

#include <atomic>
#include <functional>
#include <string>

#include "board.hpp"
#include "metier/base/error.hpp"
#include "metier/http/http_limits.hpp"

namespace metier::dashboard {

/// The streams of all tabs, as server-sent events.
///
/// Threading: any; each stream keeps the thread of its connection.
class Streams {
public:
    /// Both must outlive this.
    Streams(Board& board, const http::HttpLimits& limits) : board_(board), limits_(limits) {}

    /// Callbacks for the owner of a stream. Called on the connection's thread.
    struct Listener {
        std::function<bool()> may_listen;  ///< asked several times a second: else the stream ends
        std::function<void()> on_end;      ///< called once, when the tab has gone
    };

    /// Has the response be the stream of a new tab, of that name.
    /// Errors: resource_unavailable, if there are too many.
    Result<void> begin(const std::string& tab, httplib::Response& response, Listener listener);

private:
    Board& board_;
    const http::HttpLimits& limits_;
    std::atomic<std::size_t> open_ = 0;
};

}  // namespace metier::dashboard
