// Rights of each role at each node of a closed server: its Variables and its Methods.
#include <gmock/gmock.h>

#include <map>
#include <set>

#include "installation.hpp"

namespace metier::system_tests {
namespace {

using opcua::AttributeId;
using opcua::NodeClass;
using opcua::NodeId;

struct MethodOf {
    NodeId object;
    NodeId method;
    std::string name;
};

/// All that hangs below the Objects folder, each node once.
struct Nodes {
    std::vector<NodeId> variables;
    std::vector<MethodOf> methods;
};

Nodes walk(opcua::Client& client) {
    Nodes nodes;
    std::set<NodeId> seen;
    std::vector<NodeId> open{opcua::ids::kObjectsFolder};
    while (!open.empty()) {
        const auto node = open.back();
        open.pop_back();
        const auto references = client.browse({.node = node}).value();
        for (const auto& reference : references) {
            if (reference.node_class == NodeClass::method) {
                nodes.methods.push_back({node, reference.target, reference.browse_name.name});
            } else if (seen.insert(reference.target).second) {
                if (reference.node_class == NodeClass::variable) {
                    nodes.variables.push_back(reference.target);
                }
                open.push_back(reference.target);
            }
        }
    }
    return nodes;
}

/// Any value of an argument's type.
opcua::Value valueFor(const opcua::Argument& argument) {
    using opcua::Value;
    if (argument.value_rank != -1) {
        return Value::of(std::vector<opcua::KeyValue>());
    }
    const std::map<NodeId, Value> scalars{
        {opcua::ids::kDouble, Value::of(0.0)},        {NodeId(0, 7U), Value::of(std::uint32_t{0})},
        {NodeId(0, 9U), Value::of(std::uint64_t{0})}, {NodeId(0, 12U), Value::of("a")},
        {NodeId(0, 294U), Value::of(UtcTime{})},      {NodeId(0, 1U), Value::of(false)}};
    const auto found = scalars.find(argument.data_type);
    return found == scalars.end() ? Value::of(std::int32_t{1}) : found->second;  // an enumeration
}

struct RoleRow {
    const char* name;
    bool commands;
    bool sees_certificates;  ///< of other sessions
};

class RoleMatrix : public ::testing::TestWithParam<RoleRow> {
protected:
    RoleMatrix() {
        const auto added =
            here_.run({"user", "add", "somebody", "--role", GetParam().name}, "somebody's");
        EXPECT_EQ(added.status, 0) << added.output;
        auto options = here_.asCommand();
        options.user = opcua::UserName{"somebody", "somebody's"};
        auto client = opcua::Client::connect(arm_.url(), options);
        EXPECT_TRUE(client) << client.error().message;
        client_ = std::move(*client);
        nodes_ = walk(*client_);
    }
    /// Arguments of the right types: the stack looks at those before the server at the role.
    std::vector<opcua::Value> inputsOf(const MethodOf& method) {
        std::vector<opcua::Value> inputs;
        const auto node = client_->translate(method.method, {{0, "InputArguments"}});
        if (node) {
            const auto arguments =
                client_->read(*node).value().as<std::vector<opcua::Argument>>().value();
            for (const auto& argument : arguments) {
                inputs.push_back(valueFor(argument));
            }
        }
        return inputs;
    }
    opcua::StatusCode call(const MethodOf& method) {
        const auto answer = client_->call(method.object, method.method, inputsOf(method));
        return answer ? opcua::status::kGood : answer.error().status;
    }

    const Installation here_{"here"};
    const ServerProcess arm_ = here_.serve("iiwa");
    std::unique_ptr<opcua::Client> client_;
    Nodes nodes_;
};

// Those that change nothing: everybody who is let in may ask.
const std::set<std::string> kQuestions{"GetExecution", "GetMonitoredItems", "ResendData"};

TEST_P(RoleMatrix, OfMethods) {
    std::set<std::string> names;
    for (const auto& method : nodes_.methods) {
        const auto status = call(method);
        if (status == opcua::status::kBadInternalError ||
            status == opcua::status::kBadNotExecutable) {
            continue;  // a NodeSet has it, but nothing is behind it
        }
        names.insert(method.name);
        const bool allowed = GetParam().commands || kQuestions.contains(method.name);
        if (!allowed) {
            EXPECT_EQ(status, opcua::status::kBadUserAccessDenied)
                << method.name << " " << status.name();
        } else {
            EXPECT_NE(status, opcua::status::kBadUserAccessDenied) << method.name;
        }
        if (!allowed) {
            EXPECT_FALSE(client_->readUserExecutable(method.method).value()) << method.name;
        }
    }
    for (const auto* needed : {"Start", "StartWith", "Halt", "Suspend", "Resume", "Reset", "Check",
                               "GetExecution", "AcquireControl", "InitLock"}) {
        EXPECT_TRUE(names.contains(needed)) << needed;
    }
}

// SessionSecurityDiagnosticsArray of the Server object.
const NodeId kCertificatesOfSessions{0, 3708U};

TEST_P(RoleMatrix, OfVariables) {
    constexpr std::uint8_t kMayRead = 1;
    constexpr std::uint8_t kMayWrite = 2;
    std::size_t writable = 0;
    for (const auto& variable : nodes_.variables) {
        const auto levels = client_->readMany({{variable, AttributeId::access_level},
                                               {variable, AttributeId::user_access_level},
                                               {variable, AttributeId::value}});
        ASSERT_TRUE(levels) << variable.toString();
        const auto level = (*levels)[0].value.as<std::uint8_t>().value();
        const auto mine = (*levels)[1].value.as<std::uint8_t>().value();
        const bool hidden = variable == kCertificatesOfSessions && !GetParam().sees_certificates;
        EXPECT_EQ(mine & kMayRead, hidden ? 0 : level & kMayRead) << variable.toString();
        if ((level & kMayWrite) == 0) {
            continue;
        }
        ++writable;
        EXPECT_EQ((mine & kMayWrite) != 0, GetParam().commands) << variable.toString();
        const auto written = client_->write(variable, (*levels)[2].value);
        if (!GetParam().commands) {
            ASSERT_FALSE(written) << variable.toString();
            EXPECT_EQ(written.error().status, opcua::status::kBadUserAccessDenied);
        } else if (!written) {
            EXPECT_NE(written.error().status, opcua::status::kBadUserAccessDenied)
                << variable.toString();
        }
    }
    EXPECT_GT(writable, 10U);
}

INSTANTIATE_TEST_SUITE_P(Each, RoleMatrix,
                         ::testing::Values(RoleRow{"Observer", false, false},
                                           RoleRow{"Operator", true, false},
                                           RoleRow{"Engineer", true, true},
                                           RoleRow{"SecurityAdmin", false, true}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace metier::system_tests
