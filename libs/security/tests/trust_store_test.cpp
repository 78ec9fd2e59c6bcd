#include "metier/security/trust_store.hpp"

#include <gmock/gmock.h>

#include <array>
#include <fstream>

#include "authority.hpp"

namespace metier::security {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::filesystem::path emptyFolder() {
    const auto* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    auto folder = std::filesystem::path(::testing::TempDir()) / "trust" / name;
    std::filesystem::remove_all(folder);
    return folder;
}

class Trust : public ::testing::Test {
protected:
    void put(const std::string& part, const std::string& content) {
        std::ofstream(folder_ / part, std::ios::binary) << content;
    }
    std::string verdictOn(const Certificate& certificate) { return verdictOn(certificate.der()); }
    std::string verdictOn(const std::string& der) {
        const auto checked = store_.check(der, now_);
        constexpr std::array kNames{"malformed", "untrusted",          "expired", "not_yet_valid",
                                    "revoked",   "revocation_unknown", "weak",    "wrong_use"};
        return checked ? "trusted" : kNames.at(static_cast<std::size_t>(checked.error().kind));
    }

    const UtcTime now_ = std::chrono::system_clock::now();
    const std::filesystem::path folder_ = emptyFolder();
    // What a test changes counts at once, however busy the machine.
    TrustStore store_ = TrustStore::open(folder_, 30s).value();
};

TEST_F(Trust, IsGivenToNobodyAtFirst) {
    const auto stranger = selfSigned({.name = "stranger"});
    EXPECT_EQ(verdictOn(stranger), "untrusted");
    EXPECT_THAT(store_.check(stranger.der(), now_).error().message,
                ::testing::AllOf(HasSubstr("CN=stranger"), HasSubstr(stranger.thumbprint())));
    EXPECT_THAT(store_.rejected(), IsEmpty()) << "to check writes nothing";
}

TEST_F(Trust, IsGivenByThumbprintAndTakenBack) {
    const auto client = selfSigned({.name = "client"});
    store_.keepRejected(client);
    ASSERT_THAT(store_.rejected(), ElementsAre(client));
    ASSERT_TRUE(store_.trustRejected(client.thumbprint().substr(0, 8)));
    EXPECT_THAT(store_.rejected(), IsEmpty());
    EXPECT_EQ(verdictOn(client), "trusted");
    ASSERT_TRUE(store_.distrust(client.thumbprint()));
    EXPECT_EQ(verdictOn(client), "untrusted");
    EXPECT_THAT(store_.rejected(), ElementsAre(client));
}

TEST_F(Trust, IsNotGivenByAnEmptyOrUnknownName) {
    store_.keepRejected(selfSigned({.name = "a"}));
    EXPECT_EQ(store_.trustRejected("").error().code, Errc::not_found);
    EXPECT_EQ(store_.trustRejected("zz").error().code, Errc::not_found);
    EXPECT_EQ(store_.distrust("zz").error().code, Errc::not_found);
}

TEST_F(Trust, IsNotGivenByANameThatSeveralBeginWith) {
    // Two of 17 thumbprints begin with the same hexadecimal digit.
    std::string shared;
    std::vector<Certificate> made;
    for (int i = 0; shared.empty() && i < 17; ++i) {
        made.push_back(selfSigned({.name = "client"}));
        store_.keepRejected(made.back());
        const auto alike = std::count_if(made.begin(), made.end(), [&](const Certificate& one) {
            return one.thumbprint()[0] == made.back().thumbprint()[0];
        });
        shared = alike > 1 ? made.back().thumbprint().substr(0, 1) : "";
    }
    EXPECT_EQ(store_.trustRejected(shared).error().code, Errc::invalid_argument);
}

TEST_F(Trust, FollowsFilesThatAToolPutsThere) {
    const auto client = selfSigned({});
    EXPECT_EQ(verdictOn(client), "untrusted");
    put("trusted/certs/by hand.pem", client.pem());
    EXPECT_EQ(verdictOn(client), "trusted");
    std::filesystem::remove(folder_ / "trusted/certs/by hand.pem");
    EXPECT_EQ(verdictOn(client), "untrusted");
}

TEST_F(Trust, SeesAChangeAlsoLongAfterTheLastOne) {
    const auto client = selfSigned({});
    const auto long_ago = std::filesystem::file_time_type::clock::now() - 1h;
    for (const auto* part : {"trusted/certs", "trusted/crl", "issuers/certs", "issuers/crl"}) {
        std::filesystem::last_write_time(folder_ / part, long_ago);
    }
    EXPECT_EQ(verdictOn(client), "untrusted");
    EXPECT_EQ(verdictOn(client), "untrusted") << "as remembered";
    ASSERT_TRUE(store_.trust(client));
    EXPECT_EQ(verdictOn(client), "trusted");
}

TEST_F(Trust, IsKnownFromTheFirstMomentHoweverSlowTheDiskIsThen) {
    const auto client = selfSigned({});
    ASSERT_TRUE(store_.trust(client));
    auto hurried = TrustStore::open(folder_, 0ms).value();
    EXPECT_TRUE(hurried.check(client.der(), now_));
}

TEST_F(Trust, LeavesOutFilesThatAreNoCertificates) {
    put("trusted/certs/notes.txt", "nothing");
    put("trusted/certs/empty.der", "");
    put("trusted/crl/notes.txt", "nothing");
    EXPECT_THAT(store_.trusted(), IsEmpty());
    EXPECT_EQ(verdictOn(selfSigned({})), "untrusted");
}

TEST_F(Trust, EndsWithTheTimeOfACertificate) {
    const auto expired = selfSigned({.not_after = now_ - 1h});
    const auto early = selfSigned({.not_before = now_ + 1h});
    ASSERT_TRUE(store_.trust(expired));
    ASSERT_TRUE(store_.trust(early));
    EXPECT_EQ(verdictOn(expired), "expired");
    EXPECT_EQ(verdictOn(early), "not_yet_valid");
}

TEST_F(Trust, IsNotInWeakCertificates) {
    const auto short_key = selfSigned({.key_bits = 1024});
    const auto old_hash = selfSigned({.sha1 = true});
    const auto wrong_use = selfSigned({.key_usage = "critical,cRLSign"});
    for (const auto& certificate : {short_key, old_hash, wrong_use}) {
        ASSERT_TRUE(store_.trust(certificate));
    }
    EXPECT_EQ(verdictOn(short_key), "weak");
    EXPECT_EQ(verdictOn(old_hash), "weak");
    EXPECT_EQ(verdictOn(wrong_use), "wrong_use");
}

TEST_F(Trust, IsNotInWhatIsNoCertificate) {
    EXPECT_EQ(verdictOn(std::string()), "malformed");
    EXPECT_EQ(verdictOn(std::string(100'000, '\x30')), "malformed");
}

TEST_F(Trust, ReachesThroughAnAuthorityWithItsRevocationList) {
    const Authority factory("factory");
    const auto arm = factory.sign({.name = "arm"});
    EXPECT_EQ(verdictOn(arm), "untrusted");
    ASSERT_TRUE(store_.trust(factory.certificate()));
    EXPECT_EQ(verdictOn(arm), "revocation_unknown");
    put("trusted/crl/factory.crl", factory.revocationList());
    EXPECT_EQ(verdictOn(arm), "trusted");
    put("trusted/crl/factory.crl", factory.revocationList(arm));
    EXPECT_EQ(verdictOn(arm), "revoked");
    put("trusted/crl/factory.crl", factory.revocationList({}, now_ - 1min));
    EXPECT_EQ(verdictOn(arm), "revocation_unknown");
}

TEST_F(Trust, ReachesThroughAnAuthorityBelowARootThatIsOnlyKnown) {
    const Authority root("root");
    const Authority factory("factory", &root);
    const auto arm = factory.sign({.name = "arm"});
    put("issuers/certs/root.der", root.certificate().der());
    put("issuers/crl/root.crl", root.revocationList());
    put("issuers/certs/factory.der", factory.certificate().der());
    put("issuers/crl/factory.crl", factory.revocationList());
    EXPECT_EQ(verdictOn(arm), "untrusted") << "to be known is not to be trusted";
    ASSERT_TRUE(store_.trust(factory.certificate()));
    EXPECT_EQ(verdictOn(arm), "trusted");
    EXPECT_EQ(verdictOn(arm.der() + factory.certificate().der()), "trusted") << "with its chain";
}

TEST_F(Trust, DoesNotFollowAChainThatAPeerBrings) {
    const Authority root("root");
    const Authority factory("factory", &root);
    const auto arm = factory.sign({.name = "arm"});
    ASSERT_TRUE(store_.trust(root.certificate()));
    put("trusted/crl/root.crl", root.revocationList());
    EXPECT_EQ(verdictOn(arm.der() + factory.certificate().der()), "untrusted");
}

TEST_F(Trust, DoesNotTakeAnotherAuthorityOfTheSameName) {
    const Authority factory("factory");
    const Authority impostor("factory");
    ASSERT_TRUE(store_.trust(factory.certificate()));
    put("trusted/crl/factory.crl", factory.revocationList());
    EXPECT_EQ(verdictOn(impostor.sign({.name = "arm"})), "untrusted");
}

TEST_F(Trust, IsNotGivenBySomebodyWhoIsNoAuthority) {
    const auto client = selfSigned({.name = "client"});
    ASSERT_TRUE(store_.trust(client));
    const Authority pretender("client");
    EXPECT_EQ(verdictOn(pretender.sign({.name = "arm"})), "untrusted");
}

TEST_F(Trust, OfOneInPersonEndsWithItsRevocation) {
    const Authority factory("factory");
    const auto arm = factory.sign({.name = "arm"});
    ASSERT_TRUE(store_.trust(arm));
    EXPECT_EQ(verdictOn(arm), "trusted");
    put("issuers/certs/factory.der", factory.certificate().der());
    put("issuers/crl/factory.crl", factory.revocationList(arm));
    EXPECT_EQ(verdictOn(arm), "revoked");
}

TEST_F(Trust, TakesRevocationListsOfAuthoritiesItKnowsOnly) {
    const Authority factory("factory");
    const Authority stranger("factory");
    const auto arm = factory.sign({.name = "arm"});
    ASSERT_TRUE(store_.trust(factory.certificate()));
    put("list.crl", stranger.revocationList());
    EXPECT_EQ(store_.addRevocationList(folder_ / "list.crl").error().code, Errc::not_found);
    put("list.crl", "nothing");
    EXPECT_EQ(store_.addRevocationList(folder_ / "list.crl").error().code, Errc::invalid_argument);
    put("list.crl", factory.revocationList(arm));
    ASSERT_TRUE(store_.addRevocationList(folder_ / "list.crl"));
    EXPECT_EQ(verdictOn(arm), "revoked");
}

TEST_F(Trust, KeepsTheLatestHundredToDecideOn) {
    const auto first = selfSigned({.name = "first"});
    store_.keepRejected(first);
    std::filesystem::last_write_time(folder_ / "rejected" / (first.thumbprint() + ".der"),
                                     std::filesystem::file_time_type::clock::now() - 1h);
    for (int i = 0; i < 100; ++i) {
        store_.keepRejected(selfSigned({}));
    }
    const auto kept = store_.rejected();
    EXPECT_THAT(kept, SizeIs(100));
    EXPECT_THAT(kept, ::testing::Not(::testing::Contains(first)));
}

TEST_F(Trust, EndsForEveryCopyOfACertificate) {
    const auto client = selfSigned({});
    put("trusted/certs/by hand.pem", client.pem());
    ASSERT_TRUE(store_.trust(client));
    const auto other = selfSigned({.name = "other"});
    ASSERT_TRUE(store_.trust(other));
    ASSERT_TRUE(store_.distrust(client.thumbprint()));
    EXPECT_THAT(store_.trusted(), ElementsAre(other));
    EXPECT_EQ(verdictOn(client), "untrusted");
}

TEST_F(Trust, HoldsFromTheFirstToTheLastMomentOfACertificate) {
    const auto client = selfSigned({});
    ASSERT_TRUE(store_.trust(client));
    const auto isTrusted = [&](UtcTime time) {
        return store_.check(client.der(), time).has_value();
    };
    EXPECT_FALSE(isTrusted(client.notBefore() - 1s));
    EXPECT_TRUE(isTrusted(client.notBefore()));
    EXPECT_TRUE(isTrusted(client.notAfter()));
    EXPECT_FALSE(isTrusted(client.notAfter() + 1s));
    EXPECT_THAT(store_.check(client.der(), client.notAfter() + 1s).error().message,
                HasSubstr("was valid until " + dateText(client.notAfter())));
    EXPECT_THAT(store_.check(client.der(), client.notBefore() - 1s).error().message,
                HasSubstr("is valid from " + dateText(client.notBefore())));
}

TEST_F(Trust, NeedsTheRootOfAnAuthorityAndItsList) {
    const Authority root("root");
    const Authority factory("factory", &root);
    const auto arm = factory.sign({.name = "arm"});
    ASSERT_TRUE(store_.trust(factory.certificate()));
    put("trusted/crl/factory.crl", factory.revocationList());
    EXPECT_EQ(verdictOn(arm), "untrusted") << "its root is not known";
    put("issuers/certs/root.der", root.certificate().der());
    EXPECT_EQ(verdictOn(arm), "revocation_unknown") << "the root may have revoked the authority";
    put("issuers/crl/root.crl", root.revocationList(factory.certificate()));
    EXPECT_EQ(verdictOn(arm), "revoked");
    put("issuers/crl/root.crl", root.revocationList());
    EXPECT_EQ(verdictOn(arm), "trusted");
}

TEST_F(Trust, OfOneInPersonIsNotEndedByAStrangersList) {
    const Authority factory("factory");
    const Authority stranger("factory");
    const auto arm = factory.sign({.name = "arm"});
    ASSERT_TRUE(store_.trust(arm));
    put("issuers/certs/factory.der", factory.certificate().der());
    put("issuers/crl/factory.crl", stranger.revocationList(arm));
    EXPECT_EQ(verdictOn(arm), "trusted");
    put("issuers/crl/factory.crl", factory.revocationList(arm, now_ - 1min));
    EXPECT_EQ(verdictOn(arm), "revoked") << "a list that is out of date still names it";
}

TEST_F(Trust, KeepsRevocationListsBesideTheirAuthority) {
    const Authority factory("factory");
    put("issuers/certs/factory.der", factory.certificate().der());
    put("list.crl", factory.revocationList());
    ASSERT_TRUE(store_.addRevocationList(folder_ / "list.crl"));
    const auto kept = factory.certificate().thumbprint() + ".crl";
    EXPECT_TRUE(std::filesystem::exists(folder_ / "issuers/crl" / kept));
    ASSERT_TRUE(store_.trust(factory.certificate()));
    ASSERT_TRUE(store_.addRevocationList(folder_ / "list.crl"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "trusted/crl" / kept));
    const auto missing = store_.addRevocationList(folder_ / "none.crl");
    EXPECT_EQ(missing.error().code, Errc::not_found);
    EXPECT_THAT(missing.error().message, HasSubstr("no such file"));
}

TEST_F(Trust, RefusesAlsoWhereNothingCanBeKept) {
    std::filesystem::remove_all(folder_ / "rejected");
    put("rejected", "a file");
    const auto stranger = selfSigned({});
    store_.keepRejected(stranger);
    EXPECT_THAT(store_.rejected(), IsEmpty());
    EXPECT_EQ(verdictOn(stranger), "untrusted");
    std::filesystem::remove_all(folder_ / "trusted/certs");
    put("trusted/certs", "a file");
    EXPECT_EQ(store_.trust(stranger).error().code, Errc::resource_unavailable);
    EXPECT_EQ(TrustStore::open(folder_).error().code, Errc::resource_unavailable);
}

TEST_F(Trust, TakesTheFirstThousandFilesByTheirNames) {
    for (int i = 0; i < 1'000; ++i) {
        put("trusted/certs/" + std::to_string(i), "nothing");
    }
    const auto client = selfSigned({});
    put("trusted/certs/A.der", client.der());
    EXPECT_THAT(store_.trusted(), IsEmpty()) << "digits come first";
    std::filesystem::rename(folder_ / "trusted/certs/A.der", folder_ / "trusted/certs/0.der");
    EXPECT_THAT(store_.trusted(), ElementsAre(client));
}

}  // namespace
}  // namespace metier::security
