#include "metier/security/security_folder.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace metier::security {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class SecurityFolderTest : public ::testing::Test {
protected:
    SecurityFolderTest() { fs::remove_all(path_); }
    SecurityFolder open() const { return SecurityFolder::open(path_).value(); }
    bool isTrusted(const Certificate& certificate) const {
        return TrustStore::open(open().trustFolder())
            .value()
            .check(certificate.der(), now_)
            .has_value();
    }

    const UtcTime now_ = std::chrono::system_clock::now();
    const IdentityOptions options_{.application_name = "metier arm",
                                   .application_uri = "urn:host:metier:arm:1",
                                   .hosts = {"host", "127.0.0.1"}};
    const fs::path path_ = fs::path(::testing::TempDir()) / "security_folder" /
                           ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(SecurityFolderTest, MakesAnIdentityThatItsOtherApplicationsTrust) {
    auto folder = open();
    const auto made = folder.identity("arm-1", options_, now_);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_TRUE(isTrusted(made->certificate));
    EXPECT_EQ(folder.roleOf(made->certificate.thumbprint()), Role::operator_);
    EXPECT_EQ(open().identity("arm-1", {}, now_)->certificate, made->certificate) << "once";
    const auto own = folder.own();
    ASSERT_EQ(own.size(), 1U);
    EXPECT_EQ(own[0].name, "arm-1");
    EXPECT_EQ(own[0].certificate, made->certificate);
}

TEST_F(SecurityFolderTest, IsForItsOwnerAlone) {
    ASSERT_TRUE(open().identity("arm", options_, now_));
    EXPECT_EQ(fs::status(path_).permissions(), fs::perms::owner_all);
    fs::permissions(path_, fs::perms::others_write, fs::perm_options::add);
    const auto refused = SecurityFolder::open(path_);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
    EXPECT_THAT(refused.error().message, HasSubstr("chmod 700"));
}

TEST_F(SecurityFolderTest, MakesNoNewIdentityInPlaceOfOneThatOthersMayRead) {
    ASSERT_TRUE(open().identity("arm", options_, now_));
    fs::permissions(open().identityFolder("arm") / "identity.pem", fs::perms::group_read,
                    fs::perm_options::add);
    EXPECT_EQ(open().identity("arm", options_, now_).error().code, Errc::access_denied);
}

TEST_F(SecurityFolderTest, RenewsAnIdentityForTheSameNames) {
    auto folder = open();
    const auto former = folder.identity("arm", options_, now_).value();
    const auto later = now_ + std::chrono::hours(24 * 720);
    const auto renewed = folder.renew("arm", later);
    ASSERT_TRUE(renewed) << renewed.error().message;
    EXPECT_NE(renewed->private_key, former.private_key);
    EXPECT_NE(renewed->certificate.thumbprint(), former.certificate.thumbprint());
    EXPECT_EQ(renewed->certificate.applicationUri(), "urn:host:metier:arm:1");
    EXPECT_EQ(renewed->certificate.subject(), "CN=metier arm");
    EXPECT_EQ(renewed->certificate.issuer(), "CN=metier arm");
    EXPECT_GT(renewed->certificate.notAfter(), later + std::chrono::hours(24 * 729));
    EXPECT_EQ(folder.identity("arm", {}, later)->certificate, renewed->certificate);
    EXPECT_TRUE(isTrusted(former.certificate)) << "until all know the new one";
    const auto trusted =
        TrustStore::open(folder.trustFolder()).value().check(renewed->certificate.der(), later);
    EXPECT_TRUE(trusted) << trusted.error().message;
    EXPECT_EQ(folder.roleOf(renewed->certificate.thumbprint()), Role::operator_);
}

TEST_F(SecurityFolderTest, RenewsOnlyWhatThereIs) {
    auto folder = open();
    EXPECT_EQ(folder.renew("arm", now_).error().code, Errc::not_found);
    for (const auto* name : {"", "..", "a/b", ".hidden", "a b"}) {
        EXPECT_EQ(folder.renew(name, now_).error().code, Errc::invalid_argument) << name;
        EXPECT_EQ(folder.identity(name, options_, now_).error().code, Errc::invalid_argument);
    }
}

TEST_F(SecurityFolderTest, GivesApplicationsRoles) {
    auto folder = open();
    const auto identity = folder.identity("arm", options_, now_).value();
    const auto& thumbprint = identity.certificate.thumbprint();
    ASSERT_TRUE(folder.setRole(identity.certificate, Role::observer));
    EXPECT_EQ(open().roleOf(thumbprint), Role::observer);
    ASSERT_TRUE(folder.setRole(identity.certificate, std::nullopt));
    EXPECT_EQ(folder.roleOf(thumbprint), std::nullopt);
    ASSERT_TRUE(folder.setRole(identity.certificate, std::nullopt)) << "again";
    EXPECT_EQ(folder.roleOf("../own/arm/identity.pem"), std::nullopt);
    std::ofstream(path_ / "roles" / thumbprint) << "Master\n";
    EXPECT_EQ(folder.roleOf(thumbprint), std::nullopt) << "no role of that name";
}

TEST_F(SecurityFolderTest, NamesItsIdentitiesInTheirOrder) {
    auto folder = open();
    for (const auto* name : {"ur5", "arm", "gripper"}) {
        ASSERT_TRUE(folder.identity(name, options_, now_));
    }
    fs::create_directories(path_ / "own" / "empty");
    fs::permissions(folder.identityFolder("gripper") / "identity.pem", fs::perms::others_read,
                    fs::perm_options::add);
    std::vector<std::string> names;
    for (const auto& own : folder.own()) {
        names.push_back(own.name);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"arm", "ur5"})) << "those that can be read";
}

TEST_F(SecurityFolderTest, TakesNamesUpToTheirLimit) {
    auto folder = open();
    EXPECT_TRUE(folder.identity(std::string(100, 'a'), options_, now_));
    EXPECT_EQ(folder.identity(std::string(101, 'a'), options_, now_).error().code,
              Errc::invalid_argument);
}

TEST_F(SecurityFolderTest, TrustsNoIdentityThatItCouldNotMake) {
    auto folder = open();
    EXPECT_EQ(folder.identity("arm", {.hosts = {"a b"}}, now_).error().code,
              Errc::invalid_argument);
    EXPECT_TRUE(folder.own().empty());
    EXPECT_TRUE(folder.roles().empty());
    EXPECT_TRUE(TrustStore::open(folder.trustFolder())->trusted().empty());
}

TEST_F(SecurityFolderTest, ListsRolesOfApplications) {
    auto folder = open();
    EXPECT_TRUE(folder.roles().empty());
    const auto arm = folder.identity("arm", options_, now_)->certificate;
    const auto page = folder.identity("page", options_, now_)->certificate;
    ASSERT_TRUE(folder.setRole(page, Role::security_admin));
    std::ofstream(path_ / "roles" / "notes.txt") << "Operator\n";
    std::ofstream(path_ / "roles" / std::string(40, 'a')) << "Operator and more\n";
    std::ofstream(path_ / "roles" / std::string(40, 'B')) << "Operator\n";
    const std::map<std::string, Role> both{{arm.thumbprint(), Role::operator_},
                                           {page.thumbprint(), Role::security_admin}};
    EXPECT_EQ(folder.roles(), both);
}

TEST_F(SecurityFolderTest, IsRefusedWhereAFileIs) {
    fs::create_directories(path_.parent_path());
    std::ofstream(path_) << "x";
    EXPECT_EQ(SecurityFolder::open(path_).error().code, Errc::resource_unavailable);
}

}  // namespace
}  // namespace metier::security
