// Which servers a command speaks to.
#include "command_identity.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "metier/opcua/server.hpp"
#include "metier/security/security_folder.hpp"

namespace metier::app {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

fs::path freshFolder() {
    auto folder = fs::path(::testing::TempDir()) / "metier_security" /
                  ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    return folder;
}

class Connections : public ::testing::Test {
protected:
    Connections() {
        opcua::ServerOptions options;
        options.port = 0;
        server_ = opcua::Server::create(std::move(options)).value();
    }

    void serve() const { ASSERT_TRUE(server_->start()); }
    void beALab() { security_.insecure_lab = true; }
    std::string url() const { return server_->endpointUrl(); }
    /// As a connection to a closed server was made.
    opcua::ClientOptions secured() const {
        auto folder = security::SecurityFolder::open(folder_).value();
        opcua::ClientOptions options;
        options.security = opcua::Credentials{folder
                                                  .identity("command",
                                                            {.application_name = "command",
                                                             .application_uri = "urn:test:command",
                                                             .hosts = {"localhost"}},
                                                            std::chrono::system_clock::now())
                                                  .value(),
                                              folder.trustFolder()};
        return options;
    }
    Result<void> secureNow() const {
        opcua::ClientOptions options;
        return command_.secure(options, url());
    }

    const fs::path folder_ = freshFolder();
    server::Security security_{.folder = folder_};
    const std::string user_;
    const CommandIdentity command_{security_, user_};
    std::unique_ptr<opcua::Server> server_;
};

TEST_F(Connections, AreMadeToNoOpenServerUnlessItIsALab) {
    serve();
    const auto refused = secureNow();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("has no security"), HasSubstr("--insecure-lab")));
    beALab();
    EXPECT_TRUE(secureNow());
    EXPECT_FALSE(fs::exists(folder_)) << "a lab needs no folder";
}

TEST_F(Connections, AreMadeToNoOpenServerWhereAClosedOneWas) {
    serve();
    command_.noteConnected(secured(), url());
    EXPECT_THAT(secureNow().error().message, HasSubstr("was closed before"));
    beALab();
    const auto refused = secureNow();
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("was closed before"), HasSubstr("metier trust forget " + url())));
    security_.noteServedOpen(url());
    EXPECT_TRUE(secureNow()) << "by the hand of its own user";
    command_.noteConnected(opcua::ClientOptions(), url());
    EXPECT_TRUE(secureNow()) << "an open connection proves nothing";
}

}  // namespace
}  // namespace metier::app
