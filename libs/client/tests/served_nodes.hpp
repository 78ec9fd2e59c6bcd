#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"

namespace metier::client::testing {

/// A server whose nodes a test adds one by one, as a server of another maker could have them.
/// Nodes are added before the first call of client().
class ServedNodes {
public:
    using NodeId = opcua::NodeId;

    /// \param nodesets   as ServerOptions; the types of frames and vectors come with them
    /// \param namespaces as ServerOptions; without `nodesets` the first one has the index 2
    /// \param port       0: a free one
    explicit ServedNodes(std::vector<std::string> nodesets = {},
                         std::vector<std::string> namespaces = {}, std::uint16_t port = 0)
        : server_(create(std::move(nodesets), std::move(namespaces), port)) {}

    NodeId object(const NodeId& parent, const std::string& name,
                  const NodeId& type = opcua::ids::kBaseObjectType) {
        return nodes()
            .addObject({{{}, parent, opcua::ids::kHasComponent, {1, name}},
                        type,
                        opcua::EventNotifier::none,
                        opcua::Children::none})
            .value();
    }
    NodeId program(const NodeId& parent, const std::string& name) {
        return object(parent, name, opcua::ids::kProgramStateMachineType);
    }
    NodeId variable(const NodeId& parent, const opcua::QualifiedName& name,
                    const opcua::Value& value) {
        const auto added =
            nodes().addVariable({.node = {{}, parent, opcua::ids::kHasComponent, name},
                                 .value_rank = value.isArray() ? 1 : -1,
                                 .array_dimensions = std::vector(value.isArray() ? 1U : 0U, 0U),
                                 .value = value});
        EXPECT_TRUE(added) << added.error().message;
        return added.value_or(NodeId());
    }
    NodeId variable(const NodeId& parent, const std::string& name, const opcua::Value& value) {
        return variable(parent, opcua::QualifiedName{1, name}, value);
    }
    NodeId method(const NodeId& parent, const std::string& name) {
        return nodes()
            .addMethod({{{}, parent, opcua::ids::kHasComponent, {1, name}}, {}, {}, {}})
            .value();
    }
    opcua::AddressSpace& nodes() { return server_->nodes(); }
    opcua::Server& server() { return *server_; }
    /// Ends client and server; nothing else may be called then.
    void end() {
        client_.reset();
        server_.reset();
    }
    std::uint16_t port() const { return server_->port(); }

    /// Starts the server.
    std::string url() {
        static_cast<void>(client());
        return server_->endpointUrl();
    }
    /// Starts the server.
    opcua::Client& client() {
        if (!client_) {
            EXPECT_TRUE(server_->start());
            client_ = opcua::Client::connect(server_->endpointUrl()).value();
        }
        return *client_;
    }

private:
    static std::unique_ptr<opcua::Server> create(std::vector<std::string> nodesets,
                                                 std::vector<std::string> namespaces,
                                                 std::uint16_t port) {
        opcua::ServerOptions options;
        options.port = port;
        options.nodesets = std::move(nodesets);
        options.namespaces = std::move(namespaces);
        return opcua::Server::create(std::move(options)).value();
    }

    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua::Client> client_;
};

}  // namespace metier::client::testing
