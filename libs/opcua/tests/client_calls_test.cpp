#include "client/client_calls.hpp"

#include <gtest/gtest.h>
#include <open62541/types_generated.h>

#include <new>
#include <vector>

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;

constexpr SteadyTime kStart{1h};

class ClientCallsTest : public ::testing::Test {
protected:
    ClientCalls::Call& addCall(SteadyTime deadline) {
        return calls.add(deadline, [this](const ClientCalls::Ending& ending) {
            outcomes.push_back(ending.status);
            sent = ending.sent;
        });
    }
    void answer(ClientCalls::Call& call, UA_StatusCode result) {
        UA_ReadResponse response{};
        response.responseHeader.serviceResult = result;
        ClientCalls::onResponse(nullptr, &call, 1, &response);
    }

    ClientCalls calls;
    std::vector<StatusCode> outcomes;
    bool sent = true;  // of the last call
};

TEST_F(ClientCallsTest, HandsTheServiceResultOverOnce) {
    answer(addCall(kStart + 1s), UA_STATUSCODE_BADNOTHINGTODO);
    calls.expire(kStart + 2s);
    EXPECT_EQ(outcomes, std::vector{StatusCode(UA_STATUSCODE_BADNOTHINGTODO)});
    EXPECT_EQ(calls.size(), 0U);
}

TEST_F(ClientCallsTest, EndsACallAtItsDeadlineAndNotBefore) {
    addCall(kStart + 1s);
    calls.expire(kStart + 999ms);
    EXPECT_TRUE(outcomes.empty());
    EXPECT_EQ(calls.nextDeadline(), kStart + 1s);
    calls.expire(kStart + 1s);
    EXPECT_EQ(outcomes, std::vector{status::kBadTimeout});
    EXPECT_FALSE(calls.nextDeadline());
}

TEST_F(ClientCallsTest, CountsACallUntilTheStackReturnsItAndTellsNoLateAnswer) {
    auto& call = addCall(kStart + 1s);
    calls.expire(kStart + 1s);
    EXPECT_EQ(calls.size(), 1U);
    answer(call, UA_STATUSCODE_GOOD);
    EXPECT_EQ(calls.size(), 0U);
    EXPECT_EQ(outcomes.size(), 1U);
}

TEST_F(ClientCallsTest, EndsAllCallsWithOneStatus) {
    addCall(kStart + 1s);
    addCall(kStart + 2s);
    calls.failAll(status::kBadConnectionClosed);
    EXPECT_EQ(outcomes, std::vector(2, status::kBadConnectionClosed));
}

TEST_F(ClientCallsTest, ForgetsWhatTheStackDidNotTake) {
    calls.refuse(addCall(kStart + 1s), status::kBadNotConnected);
    EXPECT_FALSE(sent);
    calls.drop(addCall(kStart + 1s));
    EXPECT_EQ(calls.size(), 0U);
    EXPECT_EQ(outcomes, std::vector{status::kBadNotConnected});
}

TEST_F(ClientCallsTest, MayBeAddedToWhileACallEnds) {
    calls.add(kStart, [this](const ClientCalls::Ending& /*ending*/) { addCall(kStart + 1s); });
    calls.expire(kStart);
    EXPECT_EQ(calls.nextDeadline(), kStart + 1s);
}

TEST_F(ClientCallsTest, EndsThoseWhoseDeadlineHasPassedInTheirOrder) {
    std::vector<int> order;
    for (const int seconds : {3, 1, 2}) {
        calls.add(kStart + std::chrono::seconds(seconds),
                  [&order, seconds](const auto& /*ending*/) { order.push_back(seconds); });
    }
    calls.expire(kStart + 2s);
    EXPECT_EQ(order, (std::vector{1, 2}));
    EXPECT_EQ(calls.nextDeadline(), kStart + 3s);
}

TEST_F(ClientCallsTest, EndsACallAgainIfMemoryRanOutOverItsAnswer) {
    auto& call = calls.add(kStart + 1s, [this](const ClientCalls::Ending& ending) {
        if (ending.response != nullptr) {
            throw std::bad_alloc();
        }
        outcomes.push_back(ending.status);
    });
    answer(call, UA_STATUSCODE_GOOD);
    EXPECT_EQ(outcomes, std::vector{status::kBadOutOfMemory});
    EXPECT_EQ(calls.size(), 0U);
    EXPECT_FALSE(calls.nextDeadline());
}

TEST_F(ClientCallsTest, EndsNoCallTwice) {
    auto& refused = addCall(kStart + 1s);
    auto& dropped = addCall(kStart + 1s);
    calls.failAll(status::kBadConnectionClosed);
    calls.refuse(refused, status::kBadNotConnected);
    calls.drop(dropped);
    EXPECT_EQ(outcomes, std::vector(2, status::kBadConnectionClosed));
    EXPECT_EQ(calls.size(), 0U);
}

}  // namespace
}  // namespace metier::opcua
