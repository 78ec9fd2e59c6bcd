#include "metier/opcua/search.hpp"

#include <gmock/gmock.h>

#include "metier/opcua/discovery.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class Search : public ::testing::Test {
protected:
    static std::unique_ptr<opcua::Server> startLds() {
        opcua::ServerOptions options;
        options.port = 0;
        options.discovery.emplace();
        auto server = opcua::Server::create(std::move(options)).value();
        EXPECT_TRUE(server->start());
        return server;
    }
    void announce(const opcua::Server& lds, const std::string& name,
                  std::vector<std::string> urls) {
        ASSERT_TRUE(opcua::registerServer(
            lds.endpointUrl(),
            {.application_uri = "urn:" + name, .name = name, .discovery_urls = std::move(urls)}));
    }

    std::unique_ptr<opcua::Server> lds_ = startLds();
};

TEST_F(Search, TellsEachAddressOnceWhoeverKnowsIt) {
    const auto other = startLds();
    announce(*lds_, "b", {"opc.tcp://b:1"});
    announce(*lds_, "a", {"opc.tcp://a:1"});
    announce(*other, "a", {"opc.tcp://a:1"});
    const auto sighting = askDiscoveryServers({lds_->endpointUrl(), other->endpointUrl()});
    EXPECT_THAT(sighting.problems, IsEmpty());
    EXPECT_THAT(sighting.servers, ElementsAre(Field(&FoundServer::url, "opc.tcp://a:1"),
                                              Field(&FoundServer::url, "opc.tcp://b:1")));
    EXPECT_EQ(sighting.servers.front().name, "a");
    EXPECT_EQ(sighting.servers.front().reported_by, lds_->endpointUrl());
}

TEST_F(Search, LeavesOutWhatNoClientOfOursCanReach) {
    announce(*lds_, "web", {"https://web:443"});
    announce(*lds_, "both", {"https://both:443", "opc.tcp://both:1"});
    announce(*lds_, "long", {"opc.tcp://" + std::string(2'000, 'x')});
    announce(*lds_, "evil", {"opc.tcp://evil\x1b[2J:1"});
    const auto sighting = askDiscoveryServers({lds_->endpointUrl()});
    EXPECT_THAT(sighting.servers, ElementsAre(Field(&FoundServer::url, "opc.tcp://both:1")));
}

TEST_F(Search, ShowsNamesThatAreSafeToPrint) {
    announce(*lds_, "evil\x1b[2J", {"opc.tcp://evil:1"});
    const auto sighting = askDiscoveryServers({lds_->endpointUrl()});
    ASSERT_THAT(sighting.servers, SizeIs(1));
    EXPECT_EQ(sighting.servers.front().name.find('\x1b'), std::string::npos);
}

TEST_F(Search, TellsOfTheOthersIfOneDiscoveryServerIsDown) {
    announce(*lds_, "a", {"opc.tcp://a:1"});
    const auto sighting = askDiscoveryServers({"opc.tcp://127.0.0.1:1", lds_->endpointUrl()});
    EXPECT_THAT(sighting.servers, SizeIs(1));
    ASSERT_THAT(sighting.problems, SizeIs(1));
    EXPECT_THAT(sighting.problems.front().message,
                HasSubstr("discovery server opc.tcp://127.0.0.1:1"));
}

TEST(FoundServers, AreMergedByAddressAndSortedByName) {
    std::vector<FoundServer> servers{{"opc.tcp://b:1", "b", "first"}};
    merge(servers, {{"opc.tcp://a:2", "a", "second"},
                    {"opc.tcp://b:1", "another name", "second"},
                    {"opc.tcp://a:1", "a", "second"},
                    {"opc.tcp://a:1", "a", "third"}});
    std::vector<std::string> found;
    for (const auto& server : servers) {
        found.push_back(server.url + " " + server.name + " " + server.reported_by);
    }
    EXPECT_THAT(found, ElementsAre("opc.tcp://a:1 a second", "opc.tcp://a:2 a second",
                                   "opc.tcp://b:1 b first"));
}

}  // namespace
}  // namespace metier::opcua
