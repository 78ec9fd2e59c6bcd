#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "metier/dashboard/connector.hpp"
#include "server_link.hpp"

namespace metier::dashboard {

/// Keeps a link to one server, as long as this lives: makes a new one whenever it is lost.
///
/// Threading: a thread of its own; the functions from any.
class ServerWatch {
public:
    /// \param connector must outlive this, as what the context refers to
    ServerWatch(LinkContext context, const Connector& connector);
    ~ServerWatch();
    ServerWatch(const ServerWatch&) = delete;
    ServerWatch& operator=(const ServerWatch&) = delete;

    const CellServer& server() const noexcept { return context_.server; }
    /// The present link; nullptr while there is none.
    std::shared_ptr<ServerLink> link() const;
    /// Whether what changes all the time is to be shown.
    void showLive(bool shown);

private:
    /// Reports of the client's thread about a link; outlives this if the client does.
    struct News {
        std::mutex mutex;
        std::condition_variable_any changed;
        std::uint64_t link = 0;  ///< number of the present one
        std::optional<std::string> lost{};
        bool live = false;
    };

    void run(const std::stop_token& stop);
    /// Shows on the board why not.
    std::shared_ptr<ServerLink> connect();
    void keep(ServerLink& link, const std::stop_token& stop);
    void present(std::shared_ptr<ServerLink> link);

    const LinkContext context_;
    const Connector& connector_;
    // Shared with a client's callback
    const std::shared_ptr<News> news_ = std::make_shared<News>();
    mutable std::mutex mutex_;          // guards the next one
    std::shared_ptr<ServerLink> link_;  // shared with the requests that use it at this moment
    std::jthread thread_;               // last: it uses everything above
};

}  // namespace metier::dashboard
