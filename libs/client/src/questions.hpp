#pragma once

#include <chrono>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

/// Asks a server one thing after the other, where its answers decide what it is asked next. A
/// server that means no good would have more to tell for ever, or tell it slowly: after 30 s, or
/// 50,000 questions, everything else fails with timeout.
///
/// Threading: as Client. Must end before it.
class Questions {
public:
    explicit Questions(opcua::Client& client) : client_(client) {}

    opcua::Answer<std::vector<opcua::ReferenceDescription>> browse(opcua::BrowseQuery query);
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
