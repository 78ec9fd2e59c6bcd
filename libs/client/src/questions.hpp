#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

/// A failure that is found on this side.
inline opcua::Failure failureOf(Errc code, std::string text, opcua::StatusCode status) {
    return {{code, std::move(text)}, status, {}};
}
inline opcua::Failure failureOf(Errc code, std::string text) {
    return failureOf(code, std::move(text), opcua::statusFrom(code));
}

/// Requests to a server in which the answers decide about the next requests. A hostile server could
/// give more to ask for without end, or answer slowly: after 30 s, or 50,000 requests, everything
/// else fails with timeout.
///
/// Threading: as Client. Must end before it.
class Questions {
public:
    explicit Questions(opcua::Client& client) : client_(client) {}

    opcua::Answer<std::vector<opcua::Reference>> browse(opcua::BrowseQuery query);
    opcua::Answer<opcua::Value> read(const opcua::NodeId& node,
                                     opcua::AttributeId attribute = opcua::AttributeId::value);
    opcua::Answer<std::vector<opcua::DataValue>> readMany(std::vector<opcua::ReadItem> items);

private:
    opcua::Answer<> next();

    opcua::Client& client_;
    SteadyTime end_ = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    int left_ = 50'000;
};

}  // namespace metier::client
