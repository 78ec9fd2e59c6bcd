// Opening of connections by TcpConnectionManager: listening, accepting and connecting.

#include <open62541/plugin/log.h>

#include <array>
#include <asio/buffer.hpp>
#include <asio/ip/host_name.hpp>
#include <asio/post.hpp>
#include <utility>

#include "tcp_connection_manager.hpp"

namespace metier::opcua {

namespace {

using asio::ip::tcp;

// Pause after running out of file descriptors.
constexpr std::chrono::milliseconds kAcceptRetry{100};

/// Answers the peer BadTcpServerTooBusy and no reason (OPC 10000-6, 7.1.2.5), if it listens;
/// closes.
void refuse(tcp::socket& socket) {
    constexpr std::array<unsigned char, 16> kTooBusy{'E', 'R', 'R',  'F',  16,   0,    0,    0,
                                                     0,   0,   0x7D, 0x80, 0xFF, 0xFF, 0xFF, 0xFF};
    asio::error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(asio::buffer(kTooBusy), ignored);
    socket.close(ignored);
}

}  // namespace

Result<> TcpConnectionManager::listen(const TcpParameters& parameters,
                                      const Application& application) {
    auto acceptors = openAcceptors(reactor_.io(), parameters);
    if (!acceptors) {
        note(acceptors.error().message);
        return fail(acceptors.error());
    }
    if (!parameters.validate) {
        for (auto& acceptor : *acceptors) {
            announce(std::move(acceptor), application);
        }
    }
    return {};
}

void TcpConnectionManager::announce(OpenAcceptor open, const Application& application) {
    const auto id = ++last_id_;
    auto made = std::make_unique<Listener>(
        Listener{id, std::move(open.acceptor), application, open.address});
    auto& listener = *listeners_.emplace(id, std::move(made)).first->second;
    asio::error_code ignored;  // without the machine's name its address is announced empty
    const auto host =
        open.address.address.empty() ? asio::ip::host_name(ignored) : open.address.address;
    UA_String address = asStackString(host);
    std::array pairs{parameterOf("listen-address", address),
                     parameterOf("listen-port", open.address.port)};
    const UA_KeyValueMap parameters{pairs.size(), pairs.data()};
    auto& told = listener.application;
    told.callback(&handle_, id, told.application, &told.context, UA_CONNECTIONSTATE_ESTABLISHED,
                  &parameters, UA_BYTESTRING_NULL);
    UA_LOG_INFO(options_.logger, UA_LOGCATEGORY_NETWORK, "TCP %lu | listens on \"%s\", port %u",
                static_cast<unsigned long>(id), open.address.address.c_str(),
                static_cast<unsigned>(open.address.port));
    if (!listener.closing) {
        accept(listener);
    }
}

void TcpConnectionManager::accept(Listener& listener) {
    listener.acceptor.async_accept(reactor_.guarded(
        [this, id = listener.id](const asio::error_code& error, tcp::socket socket) {
            onAccepted(id, error, std::move(socket));
        }));
}

void TcpConnectionManager::onAccepted(ConnectionId id, const asio::error_code& error,
                                      tcp::socket socket) {
    const auto found = listeners_.find(id);
    if (found == listeners_.end() || found->second->closing) {
        return;
    }
    auto& listener = *found->second;
    if (!error) {
        startAccepted(listener, std::move(socket));
    }
    if (listener.closing) {
        return;
    }
    if (!error || error == asio::error::connection_aborted) {
        accept(listener);
        return;
    }
    note("cannot accept on port " + std::to_string(listener.address.port) + ": " + error.message());
    listener.timer.expires_after(kAcceptRetry);
    listener.timer.async_wait(reactor_.guarded([this, id](const asio::error_code& cancelled) {
        const auto again = listeners_.find(id);
        if (!cancelled && again != listeners_.end() && !again->second->closing) {
            accept(*again->second);
        }
    }));
}

void TcpConnectionManager::startAccepted(Listener& listener, tcp::socket socket) {
    makeRoom();
    if (isFull()) {
        ++counts_.refused;
        refuse(socket);
        return;
    }
    asio::error_code gone;
    const auto remote = socket.remote_endpoint(gone);
    if (gone) {
        return;
    }
    auto& connection = add(std::move(socket), listener.application, Origin::accepted);
    connection.address = remote.address().to_string();
    publisher_.accepted(connection.id());
    ++counts_.accepted;
    beginAsStranger(connection);
    UA_String address = asStackString(connection.address);
    auto parameter = parameterOf("remote-address", address);
    if (connection.configure(options_.kernel_send_buffer)) {
        closeLater(connection);
    }
    tell(connection, UA_CONNECTIONSTATE_ESTABLISHED, {1, &parameter}, UA_BYTESTRING_NULL);
    if (!connection.closing()) {
        awaitReadable(connection);
    }
}

void TcpConnectionManager::connect(const TcpParameters& parameters,
                                   const Application& application) {
    auto& connection = add(tcp::socket(reactor_.io()), application, Origin::opened);
    const auto id = connection.id();
    limitConnecting(connection, parameters.addresses.front());
    tell(connection, UA_CONNECTIONSTATE_OPENING, UA_KEYVALUEMAP_NULL, UA_BYTESTRING_NULL);
    if (!connection.closing()) {
        resolve(id, parameters);
    }
}

void TcpConnectionManager::limitConnecting(Connection& connection, const std::string& target) {
    connection.timer().expires_after(options_.connect_limit);
    connection.timer().async_wait(
        reactor_.guarded([this, id = connection.id(), target](const asio::error_code& cancelled) {
            auto* late = cancelled ? nullptr : find(id);
            if (late != nullptr && !late->connected) {
                note("cannot connect to " + target + ": no answer within " +
                     std::to_string(options_.connect_limit.count()) + " ms");
                closeLater(*late);
            }
        }));
}

void TcpConnectionManager::resolve(ConnectionId id, const TcpParameters& parameters) {
    const auto& host = parameters.addresses.front();
    const auto target = host + ", port " + std::to_string(parameters.port);
    asio::error_code is_name;
    const auto address = asio::ip::make_address(host, is_name);
    if (!is_name) {
        tryNext(id, {{address, parameters.port}}, target);
        return;
    }
    // In a thread of Asio's: the owner thread never waits for a name server
    resolver_.async_resolve(
        host, std::to_string(parameters.port),
        reactor_.guarded(
            [this, id, target](const asio::error_code&, const tcp::resolver::results_type& found) {
                Endpoints endpoints;
                for (auto entry = found.begin(); entry != found.end(); ++entry) {
                    endpoints.insert(endpoints.begin(), entry->endpoint());
                }
                tryNext(id, std::move(endpoints), target);
            }));
}

/// \param endpoints to be tried, the last first
void TcpConnectionManager::tryNext(ConnectionId id, Endpoints endpoints,
                                   const std::string& target) {
    auto* connection = find(id);
    if (connection == nullptr) {
        return;
    }
    if (endpoints.empty()) {
        note("cannot connect to " + target);
        closeLater(*connection);
        return;
    }
    const auto endpoint = endpoints.back();
    endpoints.pop_back();
    asio::error_code ignored;  // of the attempt before, or reported by async_connect
    connection->socket().close(ignored);
    connection->socket().async_connect(
        endpoint, reactor_.guarded([this, id, endpoints = std::move(endpoints),
                                    target](const asio::error_code& error) mutable {
            if (error) {
                tryNext(id, std::move(endpoints), target + " (" + error.message() + ")");
            } else {
                onConnected(id);
            }
        }));
}

void TcpConnectionManager::onConnected(ConnectionId id) {
    auto* connection = find(id);
    if (connection == nullptr) {
        return;
    }
    connection->timer().cancel();
    connection->connected = true;
    if (connection->configure(options_.kernel_send_buffer)) {
        closeLater(*connection);
        return;
    }
    tell(*connection, UA_CONNECTIONSTATE_ESTABLISHED, UA_KEYVALUEMAP_NULL, UA_BYTESTRING_NULL);
    if (!connection->closing()) {
        awaitReadable(*connection);
    }
}

void TcpConnectionManager::closeListener(Listener& listener) {
    if (listener.closing) {
        return;
    }
    listener.close();
    asio::post(reactor_.io(), reactor_.guarded([this, id = listener.id] { finishListener(id); }));
}

void TcpConnectionManager::finishListener(ConnectionId id) {
    const auto found = listeners_.find(id);
    if (found == listeners_.end()) {
        return;
    }
    const auto listener = std::move(found->second);
    listeners_.erase(found);
    auto& told = listener->application;
    told.callback(&handle_, id, told.application, &told.context, UA_CONNECTIONSTATE_CLOSING,
                  &UA_KEYVALUEMAP_NULL, UA_BYTESTRING_NULL);
}

}  // namespace metier::opcua
