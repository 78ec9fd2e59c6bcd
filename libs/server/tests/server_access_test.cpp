// Closed servers: who is let in, and for how long.
#include <gmock/gmock.h>

#include "host/server_access.hpp"
#include "lab.hpp"
#include "metier/base/queue.hpp"
#include "metier/opcua/server.hpp"

namespace metier::server::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::SizeIs;

constexpr const char* kPassword = "correct horse";

class ClosedServer : public ::testing::Test {
protected:
    ClosedServer() {
        auto folder = security_.openFolder().value();
        security::UserTable users;
        EXPECT_TRUE(users.add("ann", security::Role::operator_, kPassword));
        EXPECT_TRUE(users.save(folder.usersFile()));
        opcua::ServerOptions options;
        options.port = 0;
        options.application_uri = "urn:lab";
        auto access = secureServer(options, identity_, clock_);
        EXPECT_TRUE(access && *access != nullptr);
        uri_ = options.application_uri;
        access_ = std::move(*access);
        server_ = opcua::Server::create(std::move(options)).value();
        access_->follow(*server_);
        EXPECT_TRUE(server_->start());
    }
    ~ClosedServer() override {
        server_->stop();
        access_.reset();
        fs::remove_all(folder_);
    }

    /// Another application of this machine, in a folder of its own.
    opcua::ClientOptions stranger() const {
        const Security own{.folder = folder_ / "stranger"};
        opcua::ClientOptions options;
        options.security = own.credentials("stranger", {.application_name = "stranger",
                                                        .application_uri = "urn:test:stranger",
                                                        .hosts = {"localhost"}})
                               .value();
        // It trusts the server; whether the server trusts it is the question.
        auto store = security::TrustStore::open(options.security->trust_folder).value();
        EXPECT_TRUE(store.trust(identity_.credentials()->identity.certificate));
        return options;
    }
    opcua::ClientOptions known() const {
        opcua::ClientOptions options;
        EXPECT_TRUE(command_.secure(options, server_->endpointUrl()));
        return options;
    }
    auto connect(const opcua::ClientOptions& options) const {
        return opcua::Client::connect(server_->endpointUrl(), options);
    }
    /// A change of the folder holds soon, not at once.
    auto connectInTheEnd(const opcua::ClientOptions& options) const {
        const auto deadline = inAMinute();
        auto client = connect(options);
        while (!client && std::chrono::steady_clock::now() < deadline) {
            client = connect(options);
        }
        return client;
    }
    security::TrustStore store() const {
        return security::TrustStore::open(security_.openFolder()->trustFolder()).value();
    }

    static Identity make(const Security& security, const std::string& name) {
        return Identity::create(security, name,
                                {.application_name = name,
                                 .application_uri = "urn:test:" + name,
                                 .hosts = {"localhost"}})
            .value();
    }

    const fs::path folder_ = freshFolder();
    const Security security_{.folder = folder_ / "security"};
    const SystemClock clock_;
    const Identity identity_ = make(security_, "server");
    const Identity command_ = make(security_, "command");
    std::string uri_;
    std::unique_ptr<ServerAccess> access_;
    std::unique_ptr<opcua::Server> server_;
};

TEST_F(ClosedServer, HasTheUriOfItsCertificate) {
    EXPECT_EQ(uri_, "urn:test:server");
}

TEST_F(ClosedServer, LetsInApplicationsOfItsOwnFolder) {
    const auto client = connect(known());
    ASSERT_TRUE(client) << client.error().message;
    EXPECT_TRUE((*client)->read(opcua::ids::kServer, opcua::AttributeId::browse_name));
}

TEST_F(ClosedServer, LetsNobodyInWithoutSecurity) {
    EXPECT_FALSE(connect({}));
}

TEST_F(ClosedServer, KeepsStrangersToBeDecidedOn) {
    const auto options = stranger();
    EXPECT_FALSE(connect(options));
    const auto deadline = inAMinute();
    Queue<int> nothing(1);
    while (store().rejected().empty() && std::chrono::steady_clock::now() < deadline) {
        static_cast<void>(
            nothing.popUntil(std::chrono::steady_clock::now() + std::chrono::milliseconds(50)));
    }
    ASSERT_THAT(store().rejected(), SizeIs(1));
    EXPECT_EQ(store().rejected().front().thumbprint(),
              options.security->identity.certificate.thumbprint());
}

TEST_F(ClosedServer, LetsTrustedStrangersInAsUsersOnly) {
    auto options = stranger();
    ASSERT_TRUE(store().trust(options.security->identity.certificate));
    options.user = opcua::UserName{"ann", kPassword};
    {
        const auto as_user = connectInTheEnd(options);
        EXPECT_TRUE(as_user) << as_user.error().message;
    }
    options.user = opcua::UserName{"ann", "wrong horse"};
    EXPECT_EQ(connect(options).error().code, Errc::access_denied);
    options.user.reset();
    const auto alone = connect(options);
    ASSERT_FALSE(alone) << "it has no role of its own";
    EXPECT_EQ(alone.error().code, Errc::access_denied);
}

TEST_F(ClosedServer, ClosesTheSessionsOfWhomItTrustsNoLonger) {
    auto options = stranger();
    ASSERT_TRUE(store().trust(options.security->identity.certificate));
    options.user = opcua::UserName{"ann", kPassword};
    const auto client = connectInTheEnd(options);
    ASSERT_TRUE(client) << client.error().message;
    const auto stays = connect(known());
    ASSERT_TRUE(stays);
    Queue<int> losses(1);
    (*client)->onConnectionLost(
        [&losses](const opcua::Failure& /*why*/) { static_cast<void>(losses.tryPush(1)); });
    ASSERT_TRUE(store().distrust(options.security->identity.certificate.thumbprint()));
    EXPECT_TRUE(losses.popUntil(inAMinute()));
    EXPECT_EQ((*stays)->state(), opcua::Client::State::connected);
}

TEST_F(ClosedServer, ClosesTheSessionsOfUsersWhoAreGone) {
    auto options = stranger();
    ASSERT_TRUE(store().trust(options.security->identity.certificate));
    options.user = opcua::UserName{"ann", kPassword};
    const auto client = connectInTheEnd(options);
    ASSERT_TRUE(client) << client.error().message;
    Queue<int> losses(1);
    (*client)->onConnectionLost(
        [&losses](const opcua::Failure& /*why*/) { static_cast<void>(losses.tryPush(1)); });
    ASSERT_TRUE(security::UserTable().save(security_.openFolder()->usersFile()));
    EXPECT_TRUE(losses.popUntil(inAMinute()));
    EXPECT_EQ(connect(options).error().code, Errc::access_denied);
}

TEST(OpenServer, StaysOpenInALab) {
    const auto lab = Identity::create({.insecure_lab = true}, "lab", {}).value();
    const SystemClock clock;
    opcua::ServerOptions options;
    options.application_uri = "urn:lab";
    const auto access = secureServer(options, lab, clock);
    ASSERT_TRUE(access);
    EXPECT_EQ(*access, nullptr);
    EXPECT_FALSE(options.security);
    EXPECT_EQ(options.application_uri, "urn:lab");
}

}  // namespace
}  // namespace metier::server::testing
