// A Subscription that outlives its session: the stack continues to sample for it, without a
// session.
#include <gmock/gmock.h>

#include <atomic>

#include "bare_client.hpp"
#include "metier/opcua/client.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using testing::makeServer;

/// The first Variable of the diagnostics that the stack keeps of a session.
NodeId diagnosticsOfASession(Client& client) {
    const NodeId all_sessions(0, 3706U);  // SessionsDiagnosticsSummary
    const auto sessions =
        client.browse({.node = all_sessions, .node_classes = {NodeClass::object}});
    if (!sessions || sessions->empty()) {
        return {};
    }
    const auto variables =
        client.browse({.node = sessions->front().target, .node_classes = {NodeClass::variable}});
    for (const auto& variable : variables.value_or(std::vector<Reference>())) {
        if (variable.browse_name.name == "SessionDiagnostics") {
            return variable.target;
        }
    }
    return {};
}

/// Counts how often it is read.
NodeId addCounted(Server& server, std::atomic<int>& reads) {
    VariableSpec spec;
    spec.node = {NodeId(2, "counted"), ids::kObjectsFolder, ids::kHasComponent, {2, "counted"}};
    spec.data_type = ids::kDouble;
    spec.value = Value::of(0.0);
    auto node = server.nodes().addVariable(spec).value();
    EXPECT_TRUE(server.nodes().setDataSource(
        node, {[&reads](const Session&) { return DataValue{Value::of(1.0 + ++reads)}; }, {}}));
    return node;
}

// Found by hostile clients: the stack looked up the session of the read, which is null.
TEST(OutlivedSession, ItsSubscriptionMayWatchDiagnosticsWithoutEndingTheServer) {
    std::atomic<int> reads{0};
    const auto server = makeServer();
    const auto counted = addCounted(*server, reads);
    ASSERT_TRUE(server->start());
    const auto other = Client::connect(server->endpointUrl());
    ASSERT_TRUE(other) << other.error().message;
    const auto diagnostics = diagnosticsOfASession(**other);
    ASSERT_FALSE(diagnostics.isNull());

    BareClient client;
    ASSERT_EQ(client.connect(server->endpointUrl()), status::kGood);
    ASSERT_GT(client.subscribe(10), 0);
    std::vector<DataValue> values;
    std::vector<DataValue> counts;
    ASSERT_EQ(client.watchValue(diagnostics, 5, values), status::kGood);
    ASSERT_EQ(client.watchValue(counted, 5, counts), status::kGood);
    ASSERT_TRUE(client.runUntil([&] { return !values.empty(); }));
    ASSERT_EQ(client.closeSessionWithoutSubscriptions(), status::kGood);
    const int then = reads;
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    while (reads < then + 3 && std::chrono::steady_clock::now() < deadline) {
        ASSERT_TRUE((*other)->read(NodeId(0, 2258U)));  // CurrentTime
    }
    EXPECT_GE(reads, then + 3);
}

// The stack (1.4.11) forgets, on a transfer, the list of items that are sampled with the publishing
// interval: their end then wrote into memory that was freed.
TEST(OutlivedSession, ItsSubscriptionIsNotGivenToAnother) {
    std::atomic<int> reads{0};
    const auto server = makeServer();
    const auto counted = addCounted(*server, reads);
    ASSERT_TRUE(server->start());
    BareClient before;
    ASSERT_EQ(before.connect(server->endpointUrl()), status::kGood);
    const auto interval = before.subscribe(10);
    std::vector<DataValue> values;
    ASSERT_EQ(before.watchValue(counted, interval, values), status::kGood);
    ASSERT_TRUE(before.runUntil([&] { return !values.empty(); }));

    BareClient after;
    ASSERT_EQ(after.connect(server->endpointUrl()), status::kGood);
    EXPECT_EQ(after.takeSubscriptionOf(before), status::kBadUserAccessDenied);
    values.clear();
    EXPECT_TRUE(before.runUntil([&] { return !values.empty(); })) << "it goes on";
    ASSERT_EQ(before.closeSessionWithoutSubscriptions(), status::kGood);
    EXPECT_EQ(after.takeSubscriptionOf(before), status::kBadUserAccessDenied);
}

}  // namespace
}  // namespace metier::opcua
