#include "rtde_session.hpp"

#include <gmock/gmock.h>

#include "fake_peer.hpp"

namespace metier::virtual_ur {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// One controller that clients talk to in golden bytes.
class RtdeSessionTest : public testing::Test {
protected:
    RtdeSessionTest() { state_.timestamp = 64.008; }

    Result<void> send(RtdeSession& session, const Bytes& package) {
        return session.receive(package);
    }
    /// Answer to one package.
    Bytes answer(const Bytes& package) { return answer(session_, peer_, package); }
    Bytes answer(RtdeSession& session, FakePeer& peer, const Bytes& package) {
        peer.sent.clear();
        EXPECT_TRUE(send(session, package));
        return peer.sent.size() == 1 ? peer.sent.front() : Bytes{};
    }
    void negotiate2() { answer(bytes({0, 5, 'V', 0, 2})); }

    RobotState state_;
    ControlInputs control_;
    std::vector<std::string> written_;
    RtdeShared shared_{{5, 12, 6, 1102099},
                       500.0,
                       {state_.inputs, control_},
                       [this](const auto& names) { written_ = names; },
                       {}};
    FakePeer peer_;
    RtdeSession session_{shared_, peer_};
};

TEST_F(RtdeSessionTest, AcceptsProtocolVersions1And2Only) {
    EXPECT_EQ(answer(bytes({0, 5, 'V', 0, 2})), bytes({0, 4, 'V', 1}));
    EXPECT_EQ(answer(bytes({0, 5, 'V', 0, 1})), bytes({0, 4, 'V', 1}));
    EXPECT_EQ(answer(bytes({0, 5, 'V', 0, 3})), bytes({0, 4, 'V', 0}));
    EXPECT_EQ(answer(bytes({0, 5, 'V', 0, 0})), bytes({0, 4, 'V', 0}));
    EXPECT_EQ(answer(bytes({0, 3, 'V'})), bytes({0, 4, 'V', 0}));
}

TEST_F(RtdeSessionTest, TellsItsVersion) {
    EXPECT_EQ(answer(bytes({0, 3, 'v'})),
              bytes({0, 19, 'v', 0, 0, 0, 5, 0, 0, 0, 12, 0, 0, 0, 6, 0, 0x10, 0xD1, 0x13}));
}

TEST_F(RtdeSessionTest, Version1OutputsHaveNeitherFrequencyNorRecipe) {
    EXPECT_EQ(answer(bytes({0, 32, 'O'}, "timestamp,robot_mode,foobar12")),
              bytes({0, 25, 'O'}, "DOUBLE,INT32,NOT_FOUND"));
    EXPECT_EQ(answer(bytes({0, 23, 'O'}, "timestamp,robot_mode")),
              bytes({0, 15, 'O'}, "DOUBLE,INT32"));
    EXPECT_EQ(answer(bytes({0, 3, 'S'})), bytes({0, 4, 'S', 1}));
    peer_.sent.clear();
    state_.robot_mode = RobotMode::running;
    session_.cycle(state_);
    // 64.008 is 0x4050008312 6E978D.
    EXPECT_THAT(peer_.sent, ElementsAre(bytes({0, 15, 'U', 0x40, 0x50, 0x00, 0x83, 0x12, 0x6E, 0x97,
                                               0x8D, 0, 0, 0, 7})));
}

TEST_F(RtdeSessionTest, Version2OutputsCarryTheRecipe) {
    negotiate2();
    EXPECT_EQ(answer(joined(
                  {bytes({0, 20, 'O', 0x40, 0x7F, 0x40, 0, 0, 0, 0, 0}), bytes({}, "timestamp")})),
              bytes({0, 10, 'O', 1}, "DOUBLE"));
    EXPECT_EQ(answer(bytes({0, 3, 'S'})), bytes({0, 4, 'S', 1}));
    peer_.sent.clear();
    session_.cycle(state_);
    EXPECT_THAT(
        peer_.sent,
        ElementsAre(bytes({0, 12, 'U', 1, 0x40, 0x50, 0x00, 0x83, 0x12, 0x6E, 0x97, 0x8D})));
}

TEST_F(RtdeSessionTest, AnOutputThatIsNotFoundMakesTheRecipeInvalid) {
    negotiate2();
    EXPECT_EQ(answer(joined({bytes({0, 24, 'O', 0x40, 0x7F, 0x40, 0, 0, 0, 0, 0}),
                             bytes({}, "timestamp,foo")})),
              bytes({0, 20, 'O', 0}, "DOUBLE,NOT_FOUND"));
    EXPECT_EQ(answer(bytes({0, 3, 'S'})), bytes({0, 4, 'S', 0}));
    peer_.sent.clear();
    session_.cycle(state_);
    EXPECT_THAT(peer_.sent, IsEmpty());
}

// As ur_rtde writes its recipes.
TEST_F(RtdeSessionTest, OneCommaMayFollowTheLastOutput) {
    EXPECT_EQ(answer(bytes({0, 24, 'O'}, "timestamp,robot_mode,")),
              bytes({0, 15, 'O'}, "DOUBLE,INT32"));
    EXPECT_EQ(answer(bytes({0, 3, 'S'})), bytes({0, 4, 'S', 1}));
    EXPECT_EQ(answer(bytes({0, 25, 'O'}, "timestamp,robot_mode,,")),
              bytes({0, 25, 'O'}, "DOUBLE,INT32,NOT_FOUND"));
    EXPECT_EQ(answer(bytes({0, 25, 'O'}, "timestamp,,robot_mode,")),
              bytes({0, 25, 'O'}, "DOUBLE,NOT_FOUND,INT32"));
    EXPECT_EQ(answer(bytes({0, 4, 'O'}, ",")), bytes({0, 12, 'O'}, "NOT_FOUND"));
    negotiate2();
    const Bytes rate = bytes({0x40, 0x7F, 0x40, 0, 0, 0, 0, 0});
    EXPECT_EQ(answer(joined({bytes({0, 21, 'O'}), rate, bytes({}, "timestamp,")})),
              bytes({0, 10, 'O', 1}, "DOUBLE"));
    EXPECT_EQ(answer(bytes({0, 3, 'S'})), bytes({0, 4, 'S', 1}));
    EXPECT_EQ(answer(joined({bytes({0, 22, 'O'}), rate, bytes({}, ",timestamp,")})),
              bytes({0, 20, 'O', 0}, "NOT_FOUND,DOUBLE"));
}

TEST_F(RtdeSessionTest, OneCommaMayFollowTheLastInput) {
    EXPECT_EQ(answer(bytes({0, 24, 'I'}, "input_int_register_0,")), bytes({0, 9, 'I', 1}, "INT32"));
    answer(bytes({0, 8, 'U', 1, 0, 0, 0, 7}));
    EXPECT_EQ(state_.inputs.integers[0], 7);
    EXPECT_THAT(written_, ElementsAre("input_int_register_0"));
    EXPECT_EQ(answer(bytes({0, 25, 'I'}, "input_int_register_1,,")),
              bytes({0, 19, 'I', 0}, "INT32,NOT_FOUND"));
}

TEST_F(RtdeSessionTest, Version2DividesTheRate) {
    negotiate2();
    // 125 Hz of 500.
    answer(joined({bytes({0, 20, 'O', 0x40, 0x5F, 0x40, 0, 0, 0, 0, 0}), bytes({}, "timestamp")}));
    answer(bytes({0, 3, 'S'}));
    peer_.sent.clear();
    for (int i = 0; i < 9; ++i) {
        session_.cycle(state_);
    }
    EXPECT_EQ(peer_.sent.size(), 3U);  // in cycles 1, 5, 9
}

TEST_F(RtdeSessionTest, FrequenciesThatAreNoneAreRefused) {
    negotiate2();
    const Bytes zero = bytes({0, 0, 0, 0, 0, 0, 0, 0});
    const Bytes nan = bytes({0x7F, 0xF8, 0, 0, 0, 0, 0, 0});
    for (const auto& frequency : {zero, nan}) {
        EXPECT_EQ(answer(joined({bytes({0, 20, 'O'}), frequency, bytes({}, "timestamp")})),
                  bytes({0, 10, 'O', 0}, "DOUBLE"));
    }
    EXPECT_EQ(answer(bytes({0, 4, 'O', 1})), bytes({0, 4, 'O', 0}));
}

TEST_F(RtdeSessionTest, PauseEndsTheStream) {
    answer(bytes({0, 12, 'O'}, "timestamp"));
    answer(bytes({0, 3, 'S'}));
    EXPECT_EQ(answer(bytes({0, 3, 'P'})), bytes({0, 4, 'P', 1}));
    peer_.sent.clear();
    session_.cycle(state_);
    EXPECT_THAT(peer_.sent, IsEmpty());
}

TEST_F(RtdeSessionTest, AClientThatDoesNotReadGetsNoFurtherSamples) {
    answer(bytes({0, 12, 'O'}, "timestamp"));
    answer(bytes({0, 3, 'S'}));
    peer_.sent.clear();
    peer_.unread = 100'000;
    session_.cycle(state_);
    EXPECT_THAT(peer_.sent, IsEmpty());
}

TEST_F(RtdeSessionTest, InputsOfSeveralRecipesAreTakenAndKept) {
    EXPECT_EQ(answer(bytes({0, 23, 'I'}, "input_int_register_0")), bytes({0, 9, 'I', 1}, "INT32"));
    EXPECT_EQ(answer(bytes({0, 51, 'I'}, "input_double_register_5,,input_bit_register_127,")),
              bytes({0, 25, 'I', 0}, "DOUBLE,NOT_FOUND,BOOL"));
    EXPECT_EQ(answer(bytes({0, 48, 'I'}, "input_double_register_5,input_bit_register_64")),
              bytes({0, 15, 'I', 2}, "DOUBLE,BOOL"));
    EXPECT_EQ(answer(bytes({0, 8, 'U', 1, 0xFF, 0xFF, 0xFF, 0xFE})), Bytes{});
    EXPECT_EQ(state_.inputs.integers[0], -2);
    EXPECT_THAT(written_, ElementsAre("input_int_register_0"));
    answer(bytes({0, 13, 'U', 2, 0x3F, 0xF8, 0, 0, 0, 0, 0, 0, 1}));
    EXPECT_EQ(state_.inputs.numbers[5], 1.5);
    EXPECT_TRUE(state_.inputs.bits[64]);
    EXPECT_EQ(state_.inputs.integers[0], -2);
}

TEST_F(RtdeSessionTest, AnInputOfAnotherClientIsInUseUntilThatClientIsGone) {
    FakePeer other_peer;
    const Bytes set_up = bytes({0, 23, 'I'}, "input_int_register_0");
    {
        RtdeSession other(shared_, other_peer);
        EXPECT_EQ(answer(other, other_peer, set_up), bytes({0, 9, 'I', 1}, "INT32"));
        EXPECT_EQ(answer(set_up), bytes({0, 10, 'I', 0}, "IN_USE"));
    }
    EXPECT_EQ(answer(set_up), bytes({0, 9, 'I', 1}, "INT32"));
    // Its own it may claim again.
    EXPECT_EQ(answer(set_up), bytes({0, 9, 'I', 2}, "INT32"));
}

TEST_F(RtdeSessionTest, ARefusedRecipeClaimsNothing) {
    FakePeer other_peer;
    RtdeSession other(shared_, other_peer);
    answer(bytes({0, 27, 'I'}, "input_int_register_0,foo"));
    EXPECT_EQ(answer(other, other_peer, bytes({0, 23, 'I'}, "input_int_register_0")),
              bytes({0, 9, 'I', 1}, "INT32"));
}

TEST_F(RtdeSessionTest, ProtocolErrorsAreToldAsTextOfEachVersion) {
    EXPECT_EQ(answer(bytes({0, 8, 'U', 9, 0, 0, 0, 0})),
              joined({bytes({0, 32, 'M', 2}), bytes({}, "input recipe 9 is not set up")}));
    negotiate2();
    EXPECT_EQ(answer(bytes({0, 8, 'U', 9, 0, 0, 0, 0})),
              joined({bytes({0, 38, 'M', 28}), bytes({}, "input recipe 9 is not set up"),
                      bytes({4}, "RTDE"), bytes({2})}));
    EXPECT_EQ(answer(bytes({0, 3, 'Z'})),
              joined({bytes({0, 33, 'M', 23}), bytes({}, "unknown package type 90"),
                      bytes({4}, "RTDE"), bytes({1})}));
}

TEST_F(RtdeSessionTest, InputsOfAnotherSizeAreRefused) {
    answer(bytes({0, 23, 'I'}, "input_int_register_0"));
    EXPECT_FALSE(answer(bytes({0, 7, 'U', 1, 0, 0, 1})).empty());
    EXPECT_FALSE(answer(bytes({0, 9, 'U', 1, 0, 0, 0, 1, 0})).empty());
    EXPECT_EQ(state_.inputs.integers[0], 0);
}

TEST_F(RtdeSessionTest, AListOfNamesMayHave2048Bytes) {
    const auto package = [](std::string_view list) {
        const auto size = static_cast<int>(list.size()) + 3;
        return bytes({size / 256, size % 256, 'O'}, list);
    };
    std::string names = "timestamp";
    for (int i = 0; i < 203; ++i) {
        names += ",timestamp";
    }
    ASSERT_EQ(names.size(), 2039U);
    names += ",payload";
    EXPECT_EQ(answer(package(names)).size(), 3 + 204 * 7 + 6U);
    names += ',';
    ASSERT_EQ(names.size(), 2048U);
    answer(package(names));
    EXPECT_EQ(answer(bytes({0, 3, 'S'})), bytes({0, 4, 'S', 1}));
    names.insert(0, "robot_mode,");
    answer(package(names));
    EXPECT_EQ(answer(bytes({0, 3, 'S'})), bytes({0, 4, 'S', 0}));
}

TEST_F(RtdeSessionTest, AClientMayHave255InputRecipes) {
    const auto setUp = bytes({0, 27, 'I'}, "input_double_register_24");
    for (int id = 1; id <= 255; ++id) {
        ASSERT_EQ(answer(setUp), bytes({0, 10, 'I', id}, "DOUBLE"));
    }
    EXPECT_EQ(answer(setUp), bytes({0, 10, 'I', 0}, "DOUBLE"));
    answer(bytes({0, 12, 'U', 255, 0x40, 0x45, 0, 0, 0, 0, 0, 0}));
    EXPECT_THAT(written_, ElementsAre("input_double_register_24"));
}

TEST_F(RtdeSessionTest, PackagesMayComeInPartsAndSeveralAtOnce) {
    ASSERT_TRUE(send(session_, bytes({0, 5, 'V'})));
    ASSERT_TRUE(send(session_, bytes({0})));
    EXPECT_THAT(peer_.sent, IsEmpty());
    ASSERT_TRUE(send(session_, bytes({2, 0, 3, 'P', 0, 3, 'S', 0})));
    EXPECT_THAT(peer_.sent,
                ElementsAre(bytes({0, 4, 'V', 1}), bytes({0, 4, 'P', 1}), bytes({0, 4, 'S', 0})));
}

TEST_F(RtdeSessionTest, APackageShorterThanItsHeaderEndsTheSession) {
    const auto refused = send(session_, bytes({0, 2, 'V'}));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
}

TEST_F(RtdeSessionTest, TheDigitalOutputsOfAClientGoToTheControlInputs) {
    answer(bytes({0, 55, 'I'}, "standard_digital_output_mask,standard_digital_output"));
    EXPECT_EQ(answer(bytes({0, 6, 'U', 1, 0x0F, 0x05})), Bytes{});
    EXPECT_EQ(control_.standard_digital_output_mask, 0x0F);
    EXPECT_EQ(control_.standard_digital_output, 0x05);
}

}  // namespace
}  // namespace metier::virtual_ur
