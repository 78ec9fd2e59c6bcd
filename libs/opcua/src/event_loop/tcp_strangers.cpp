// Strangers of TcpConnectionManager: they lose their places to others.

#include <open62541/plugin/log.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "tcp_connection_manager.hpp"

namespace metier::opcua {

void TcpConnectionManager::beginAsStranger(Connection& connection) {
    if (options_.stranger_limit > std::chrono::milliseconds::zero()) {
        connection.standing = Standing::stranger;
        limitPatience(connection);
    }
}

void TcpConnectionManager::limitPatience(Connection& connection) {
    connection.patience().expires_after(options_.stranger_limit);
    connection.patience().async_wait(
        reactor_.guarded([this, id = connection.id()](const asio::error_code& cancelled) {
            auto* late = cancelled ? nullptr : find(id);
            if (late != nullptr && late->standing != Standing::member) {
                drop(*late, "has no Session in time");
            }
        }));
}

void TcpConnectionManager::vouchFor(ConnectionId id) {
    auto* connection = find(id);
    if (connection != nullptr && connection->standing == Standing::stranger) {
        connection->standing = Standing::known;
    }
}

void TcpConnectionManager::admit(ConnectionId id) {
    if (auto* connection = find(id)) {
        ++connection->sessions;
        connection->standing = Standing::member;
        connection->patience().cancel();
    }
}

void TcpConnectionManager::dismiss(ConnectionId id) {
    auto* connection = find(id);
    if (connection == nullptr || connection->sessions == 0 || --connection->sessions > 0 ||
        options_.stranger_limit == std::chrono::milliseconds::zero()) {
        return;
    }
    connection->standing = Standing::known;
    limitPatience(*connection);
}

void TcpConnectionManager::makeRoom() {
    auto* expendable = isFull() ? mostExpendable() : nullptr;
    if (expendable != nullptr) {
        drop(*expendable, "makes room for another one");
    }
}

/// Connection to close for a new one: a random stranger of the address that has most strangers, so
/// that nobody can be kept out on purpose; without strangers, the oldest connection without a
/// Session.
Connection* TcpConnectionManager::mostExpendable() {
    std::unordered_map<std::string_view, std::vector<Connection*>> strangers;
    Connection* idle = nullptr;
    for (const auto& [id, connection] : connections_) {
        if (connection->closing() || connection->standing == Standing::member) {
            continue;
        }
        if (connection->standing == Standing::stranger) {
            strangers[connection->address].push_back(connection.get());
        } else if (idle == nullptr || id < idle->id()) {
            idle = connection.get();
        }
    }
    const auto crowd = std::max_element(
        strangers.begin(), strangers.end(),
        [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    return crowd == strangers.end() ? idle : crowd->second[chance_() % crowd->second.size()];
}

void TcpConnectionManager::drop(Connection& connection, const char* reason) {
    ++counts_.dropped_strangers;
    UA_LOG_DEBUG(options_.logger, UA_LOGCATEGORY_NETWORK, "TCP %lu | closed: it %s",
                 static_cast<unsigned long>(connection.id()), reason);
    closeLater(connection);
}

}  // namespace metier::opcua
