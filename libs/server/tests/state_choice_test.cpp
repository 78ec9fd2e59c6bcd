#include "metier/server/state_choice.hpp"

#include <gtest/gtest.h>

namespace metier::server::testing {
namespace {

cell::ServerConfig onPort(std::uint16_t port) {
    cell::ServerConfig config;
    config.port = port;
    return config;
}

TEST(StateChoice, OfAServerOnAnyFreePortIsNone) {
    auto config = onPort(0);
    chooseState(config, {});
    EXPECT_EQ(config.state_folder, "");
    EXPECT_EQ(config.records.url, "");
}

TEST(StateChoice, PutsTheRecordsIntoTheFolderUnlessTheyHaveAPlace) {
    auto config = onPort(0);
    chooseState(config, {.folder = "/srv/state"});
    EXPECT_EQ(config.state_folder, "/srv/state");
    EXPECT_EQ(config.records.url, "/srv/state/records.db");

    auto placed = onPort(0);
    placed.records.url = "/srv/all.db";
    chooseState(placed, {.folder = "/srv/state"});
    EXPECT_EQ(placed.records.url, "/srv/all.db");
    chooseState(placed, {.folder = "/srv/state", .records = "/srv/other.db"});
    EXPECT_EQ(placed.records.url, "/srv/other.db");
}

TEST(StateChoice, RecordsNothingIfItIsOff) {
    auto config = onPort(0);
    config.records.url = "off";
    chooseState(config, {.folder = "/srv/state"});
    EXPECT_EQ(config.records.url, "");
}

}  // namespace
}  // namespace metier::server::testing
