#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "board.hpp"
#include "metier/dashboard/cell.hpp"
#include "metier/link/tcp_link.hpp"

namespace metier::dashboard {

/// Reports to the board where the parts of a world of virtual controllers are, while a tab is open:
/// 30 times a second while one moves, else twice.
///
/// Threading: a thread of its own; show() from any.
class WorldWatch {
public:
    /// \param board  must outlive this
    /// \param answer longest time in which the world must answer; then it is connected to anew
    WorldWatch(CellWorld world, Board& board,
               std::chrono::milliseconds answer = std::chrono::seconds(1));

    void show(bool shown);

private:
    void work(const std::stop_token& stop);
    /// Asks for the parts. \return whether one has moved; nothing, if the world does not answer
    std::optional<bool> ask();
    std::optional<std::string> askForLine();

    const CellWorld world_;
    Board& board_;
    const std::chrono::milliseconds answer_;
    std::optional<link::TcpLink> link_;
    std::string received_;
    nlohmann::json parts_;  // parts as reported last
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool shown_ = false;
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier::dashboard
