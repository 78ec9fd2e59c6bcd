#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "board.hpp"

namespace metier::dashboard {

/// Makes the board send live values, 30 times a second while a tab is open.
///
/// Threading: a thread of its own; run() from any.
class Ticker {
public:
    /// \param board must outlive this
    explicit Ticker(Board& board);

    void run(bool running);

private:
    void work(const std::stop_token& stop);

    Board& board_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool running_ = false;
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier::dashboard
