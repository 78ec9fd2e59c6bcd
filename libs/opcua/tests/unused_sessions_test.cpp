#include "server/unused_sessions.hpp"

#include <gtest/gtest.h>

namespace metier::opcua {
namespace {

NodeId session(std::uint32_t number) {
    return {1, number};
}

TEST(UnusedSessions, MakeRoomOldestFirst) {
    UnusedSessions sessions;
    EXPECT_FALSE(sessions.surplus());
    for (std::uint32_t i = 1; i <= 3; ++i) {
        sessions.created(session(i), 7);
    }
    EXPECT_EQ(sessions.surplus(), session(1));
    sessions.gone(session(1));
    EXPECT_EQ(sessions.surplus(), session(2));
    EXPECT_EQ(sessions.count(), 2U);
}

TEST(UnusedSessions, OfWhoeverCreatesMostMakeRoomFirst) {
    UnusedSessions sessions;
    sessions.created(session(1), 7);
    for (std::uint32_t i = 2; i <= 5; ++i) {
        sessions.created(session(i), 8);
    }
    EXPECT_EQ(sessions.surplus(), session(2)) << "the client that is about to log in is older";
    for (std::uint32_t i = 2; i <= 4; ++i) {
        sessions.gone(session(i));
    }
    EXPECT_EQ(sessions.surplus(), session(1));
}

}  // namespace
}  // namespace metier::opcua
